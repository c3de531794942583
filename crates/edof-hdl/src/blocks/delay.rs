//! A row of registers.

use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// What came in as many cycles ago as there are registers.
#[derive(Circuit)]
pub struct Delay<const W: usize, const N: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// In.
    pub now: Signal<In, Bits<W>>,
    /// Out.
    pub later: Signal<Out, Bits<W>>,
    row: [DFF<Bits<W>>; N],
}

impl<const W: usize, const N: usize> Logic for Delay<W, N> {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..N {
            self.row[i].clock.next = self.clock.val();
        }
        self.row[0].d.next = self.now.val();
        for i in 1..N {
            self.row[i].d.next = self.row[i - 1].q.val();
        }
        for i in (N - 1)..N {
            self.later.next = self.row[i].q.val();
        }
    }
}
