//! The stages of a design, one after the other.

use super::Pair;
use super::stage::Stage;
use super::window_guard::WindowGuard;
use crate::describe::{Circuit, kernel};
use edof_device::design::memory::WHOLE_CHAIN;
use edof_device::design::{Design, DesignError};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// The stages of a design, I, each M, F: windows in, patches out. Where F has a linear path it takes the window with I.
/// The outputs `between_*` show what stands between the stages, for observation; they cost nothing where they are left open.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct Chain {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets every vector and what was written to registers; held for 48 cycles or more, and two more pass until something can be taken.
    pub reset: Signal<In, Bit>,
    /// Drops every vector and nothing else; held for as long as `reset`.
    pub flush: Signal<In, Bit>,
    /// Two input pixels of a window are valid.
    pub window_valid: Signal<In, Bit>,
    /// The chain accepts a valid window beat in this cycle.
    pub window_ready: Signal<Out, Bit>,
    /// Two pixels, the even one low.
    pub window_data: Signal<In, Pair>,
    /// The beat is the last of its window.
    pub window_last: Signal<In, Bit>,
    /// The set of weights for this window.
    pub window_set: Signal<In, Bit>,
    /// Two output words of a patch are valid.
    pub patch_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub patch_ready: Signal<In, Bit>,
    /// Two words of the patch, the even one low.
    pub patch_data: Signal<Out, Pair>,
    /// The beat is the last of its patch.
    pub patch_last: Signal<Out, Bit>,
    /// The set that it was made with.
    pub patch_set: Signal<Out, Bit>,
    /// The word to write is valid (`edof_device::design::memory::address`).
    pub write_valid: Signal<In, Bit>,
    /// Address of the word to write.
    pub write_address: Signal<In, Bits<25>>,
    /// Word to write.
    pub write_data: Signal<In, Bits<32>>,
    /// What to show: bit 6 counters or what was read back, then stage (4 bits; 15 for the windows that come in), then which (2 bits).
    pub status_address: Signal<In, Bits<7>>,
    /// Word that `status_address` selected, one cycle later; counters have the values of the last snapshot.
    pub status: Signal<Out, Bits<32>>,
    /// A window was too short or too long, since the last reset or snapshot of the counters.
    pub window_fault: Signal<Out, Bit>,
    /// A stage offers a beat to the next (observation only).
    pub between_valid: Vec<Signal<Out, Bit>>,
    /// The next takes it.
    pub between_ready: Vec<Signal<Out, Bit>>,
    /// Two words of the beat, the even one low.
    pub between_data: Vec<Signal<Out, Pair>>,
    /// Base words of the same two elements.
    pub between_base: Vec<Signal<Out, Pair>>,
    /// The beat is the last of its vector.
    pub between_last: Vec<Signal<Out, Bit>>,
    /// The vector's set.
    pub between_set: Vec<Signal<Out, Bit>>,
    guard: WindowGuard,
    stages: Vec<Stage>,
    whole_chain: Constant<Bits<4>>,
    guard_reset: DFF<Bit>,
    guard_reset_counters: DFF<Bit>,
    guard_snapshot_1: DFF<Bit>,
    guard_snapshot: DFF<Bit>,
    guard_status: DFF<Bits<32>>,
    status_word: Signal<Local, Bits<32>>,
    _count: usize,
}

impl Chain {
    /// The chain of a design, its sets starting with these networks. Use [`Chain::checked`].
    #[must_use]
    pub fn new(design: &Design, sets: [&FixedNetwork; 2]) -> Self {
        let gaps = design.stages.len() - 1;
        Self::from_parts(ChainParts {
            between_valid: (0..gaps).map(|_| Signal::default()).collect(),
            between_ready: (0..gaps).map(|_| Signal::default()).collect(),
            between_data: (0..gaps).map(|_| Signal::default()).collect(),
            between_base: (0..gaps).map(|_| Signal::default()).collect(),
            between_last: (0..gaps).map(|_| Signal::default()).collect(),
            between_set: (0..gaps).map(|_| Signal::default()).collect(),
            guard: WindowGuard::new(&design.stage(0)),
            whole_chain: Constant::new((WHOLE_CHAIN as u64).into()),
            stages: design.stages().map(|stage| Stage::new(design, &stage, sets)).collect(),
            _count: gaps + 1,
        })
    }
}

impl Chain {
    /// [`Chain::new`], once everything fits.
    ///
    /// # Errors
    /// [`DesignError::Misfit`] names what does not.
    pub fn checked(design: &Design, sets: [&FixedNetwork; 2]) -> Result<Self, DesignError> {
        design.check()?;
        sets.iter().try_for_each(|network| design.check_network(network))?;
        Ok(Self::new(design, sets))
    }
}

impl Logic for Chain {
    #[kernel]
    fn update(&mut self) {
        for i in 0..self._count {
            self.stages[i].clock.next = self.clock.val();
            self.stages[i].reset.next = self.reset.val();
            self.stages[i].flush.next = self.flush.val();
            self.stages[i].write_valid.next = self.write_valid.val();
            self.stages[i].write_address.next = self.write_address.val();
            self.stages[i].write_data.next = self.write_data.val();
            self.stages[i].status_address.next = self.status_address.val();
        }

        // Windows, whole ones, go to I, and to F.
        self.guard.clock.next = self.clock.val();
        self.guard_reset.d.next = self.reset.val() || self.flush.val();
        self.guard_reset_counters.d.next = self.reset.val();
        self.guard_snapshot_1.d.next = self.write_valid.val()
            && (self.write_address.val().get_bits::<4>(21) == self.whole_chain.val())
            && (self.write_address.val().get_bits::<2>(19) == 3);
        self.guard_snapshot.d.next = self.guard_snapshot_1.q.val();
        self.guard.snapshot.next = self.guard_snapshot.q.val();
        self.guard.reset.next = self.guard_reset.q.val();
        self.guard.reset_counters.next = self.guard_reset_counters.q.val();
        self.guard.valid.next = self.window_valid.val();
        self.guard.data.next = self.window_data.val();
        self.guard.last.next = self.window_last.val();
        self.guard.set.next = self.window_set.val();
        self.window_ready.next = self.guard.ready.val();
        self.window_fault.next = self.guard.fault.val();
        for i in 0..(self._count - 1) {
            self.stages[i].window_valid.next = false;
            self.stages[i].window_data.next = 0.into();
            self.stages[i].window_last.next = false;
        }
        self.stages[0].data.next = self.guard.out_data.val();
        self.stages[0].base.next = 0.into();
        self.stages[0].last.next = self.guard.out_last.val();
        self.stages[0].set.next = self.guard.out_set.val();
        for i in (self._count - 1)..self._count {
            self.stages[0].valid.next = self.guard.out_valid.val() && self.stages[i].window_ready.val();
            self.stages[i].window_valid.next = self.guard.out_valid.val() && self.stages[0].ready.val();
            self.stages[i].window_data.next = self.guard.out_data.val();
            self.stages[i].window_last.next = self.guard.out_last.val();
            self.guard.out_ready.next = self.stages[0].ready.val() && self.stages[i].window_ready.val();
        }

        // From stage to stage.
        for i in 0..(self._count - 1) {
            self.stages[i + 1].valid.next = self.stages[i].out_valid.val();
            self.stages[i + 1].data.next = self.stages[i].out_data.val();
            self.stages[i + 1].base.next = self.stages[i].out_base.val();
            self.stages[i + 1].last.next = self.stages[i].out_last.val();
            self.stages[i + 1].set.next = self.stages[i].out_set.val();
            self.stages[i].out_ready.next = self.stages[i + 1].ready.val();
            self.between_valid[i].next = self.stages[i].out_valid.val();
            self.between_ready[i].next = self.stages[i + 1].ready.val();
            self.between_data[i].next = self.stages[i].out_data.val();
            self.between_base[i].next = self.stages[i].out_base.val();
            self.between_last[i].next = self.stages[i].out_last.val();
            self.between_set[i].next = self.stages[i].out_set.val();
        }

        // Patches.
        for i in (self._count - 1)..self._count {
            self.stages[i].out_ready.next = self.patch_ready.val();
            self.patch_valid.next = self.stages[i].out_valid.val();
            self.patch_data.next = self.stages[i].out_data.val();
            self.patch_last.next = self.stages[i].out_last.val();
            self.patch_set.next = self.stages[i].out_set.val();
        }

        // The host.
        self.guard_status.d.next = 0.into();
        if self.status_address.val().get_bits::<4>(2) == self.whole_chain.val() {
            self.guard_status.d.next = self.guard.too_short.val();
            if self.status_address.val().get_bit(0) {
                self.guard_status.d.next = self.guard.too_long.val();
            }
        }
        self.status_word.next = self.guard_status.q.val();
        for i in 0..self._count {
            self.status_word.next = self.status_word.val() | self.stages[i].status.val();
        }
        self.status.next = self.status_word.val();
    }
}
