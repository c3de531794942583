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
    #[literal]
    stages: Vec<Constant<Bits<4>>>,
    weights: Vec<Constant<Bits<12>>>,
    thresholds: Vec<Constant<Bits<12>>>,
    /// Rows of a set where the address lies.
    rows: DFF<Bits<12>>,
    /// Whether a set is there at all.
    known: DFF<Bit>,
    hits_q: DFF<Bit>,
    is_stage: Signal<Local, Bit>,
    weight_rows: Signal<Local, Bits<12>>,
    threshold_rows: Signal<Local, Bits<12>>,
    space: Signal<Local, Bits<2>>,
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
        self.is_stage.next = false;
        self.weight_rows.next = 1.into();
        self.threshold_rows.next = 1.into();
        for i in 0..self._count {
            if self.address.val().get_bits::<4>(21) == self.stages[i].val() {
                self.is_stage.next = true;
                self.weight_rows.next = self.weights[i].val();
                self.threshold_rows.next = self.thresholds[i].val();
            }
        }
        self.space.next = self.address.val().get_bits::<2>(19);
        // Registers beyond the shifts of both sets belong to none.
        self.known.d.next =
            self.is_stage.val() && ((self.space.val() != 3) || !self.address.val().get_bits::<11>(2).any());
        self.rows.d.next = 1.into();
        if self.space.val() == 0 {
            self.rows.d.next = self.weight_rows.val();
        } else if self.space.val() != 3 {
            self.rows.d.next = self.threshold_rows.val();
        }
        self.hits_q.d.next = self.known.q.val()
            && (self.both.val()
                || ((self.address.val().get_bits::<12>(1) >= self.rows.q.val()) == self.set.val()));
        self.hits.next = self.hits_q.q.val();
    }
}
