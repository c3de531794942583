//! Which words belong to a bank that takes none.

use crate::describe::{Circuit, kernel};
use edof_device::design::Design;
use edof_device::design::memory::rows_of_a_set;
use rust_hdl::prelude::*;

/// Whether a word for the calculator belongs to the bank in use, or to one of both (`edof_device::design::memory::set_of`). An address stands for
/// two cycles or more; the answer is there two cycles after it came.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct BankGuard {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Where a word is to be written (`edof_device::design::memory::address`).
    pub address: Signal<In, Bits<25>>,
    /// The bank in use.
    pub set: Signal<In, Bit>,
    /// Both banks count.
    pub both: Signal<In, Bit>,
    /// The word belongs to such a bank.
    pub hits: Signal<Out, Bit>,
    stages: Vec<Constant<Bits<4>>>,
    weights: Vec<Constant<Bits<12>>>,
    thresholds: Vec<Constant<Bits<12>>>,
    /// Rows of a set where the address lies.
    rows: DFF<Bits<12>>,
    /// Whether a set is there at all.
    known: DFF<Bit>,
    hits_q: DFF<Bit>,
    _count: usize,
}

impl BankGuard {
    /// For the stages of a design.
    #[must_use]
    pub fn new(design: &Design) -> Self {
        let rows = |space: usize| {
            design.stages().map(|stage| Constant::new((rows_of_a_set(&stage)[space] as u64).into())).collect()
        };
        Self::from_parts(BankGuardParts {
            stages: (0..design.stages.len() as u64).map(|stage| Constant::new(stage.into())).collect(),
            weights: rows(0),
            thresholds: rows(1),
            _count: design.stages.len(),
        })
    }
}

impl Logic for BankGuard {
    #[kernel]
    fn update(&mut self) {
        self.known.d.next = false;
        self.rows.d.next = 1.into();
        for i in 0..self._count {
            if self.address.val().get_bits::<4>(21) == self.stages[i].val() {
                self.known.d.next = true;
                if self.address.val().get_bits::<2>(19) == 0 {
                    self.rows.d.next = self.weights[i].val();
                } else if self.address.val().get_bits::<2>(19) != 3 {
                    self.rows.d.next = self.thresholds[i].val();
                } else if self.address.val().get_bits::<11>(2).any() {
                    // Registers beyond the shifts of both sets.
                    self.known.d.next = false;
                }
            }
        }
        self.hits_q.d.next = self.known.q.val()
            && (self.both.val()
                || ((self.address.val().get_bits::<12>(1) >= self.rows.q.val()) == self.set.val()));
        self.hits.next = self.hits_q.q.val();
    }
}
