//! A part that a block has or has not.

use crate::describe::{Circuit, Descriptions};
use rust_hdl::prelude::{Block, Logic, Probe};
use std::ops::{Index, IndexMut};

/// A part that a block has or has not, as it was made. rust-hdl's kernels know loops and no `if let`, so what is done with the part
/// stands in a loop over [`Optional::count`], which is 0 or 1:
///
/// ```
/// use edof_verilog::{Optional, describe::Circuit};
/// use rust_hdl::prelude::*;
///
/// /// x, a cycle later or at once.
/// #[derive(Circuit)]
/// struct Later {
///     /// Clock.
///     pub clock: Signal<In, Clock>,
///     /// What comes in.
///     pub x: Signal<In, Bits<8>>,
///     /// It.
///     pub y: Signal<Out, Bits<8>>,
///     wait: Optional<DFF<Bits<8>>>,
/// }
///
/// impl Logic for Later {
///     #[hdl_gen]
///     fn update(&mut self) {
///         self.y.next = self.x.val();
///         for i in 0..self.wait.count() {
///             self.wait[i].clock.next = self.clock.val();
///             self.wait[i].d.next = self.x.val();
///             self.y.next = self.wait[i].q.val();
///         }
///     }
/// }
///
/// for waits in [false, true] {
///     let mut later = Later::from_parts(LaterParts { wait: Optional::when(waits, DFF::default) });
///     later.connect_all();
///     assert_eq!(edof_verilog::emit(&later).unwrap().modules[0].text.contains("wait_q"), waits);
/// }
/// ```
pub struct Optional<B>(Option<[B; 1]>);

impl<B> Optional<B> {
    /// The part that `make` makes, or none.
    pub fn when(is_there: bool, make: impl FnOnce() -> B) -> Self {
        Self::from(is_there.then(make))
    }

    /// How many there are: none or one.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parts().len()
    }

    fn parts(&self) -> &[B] {
        self.0.as_ref().map_or(&[], <[B; 1]>::as_slice)
    }

    fn parts_mut(&mut self) -> &mut [B] {
        self.0.as_mut().map_or(&mut [], <[B; 1]>::as_mut_slice)
    }
}

impl<B> From<Option<B>> for Optional<B> {
    fn from(part: Option<B>) -> Self {
        Self(part.map(|part| [part]))
    }
}

impl<B> Index<usize> for Optional<B> {
    type Output = B;

    fn index(&self, index: usize) -> &B {
        &self.parts()[index]
    }
}

impl<B> IndexMut<usize> for Optional<B> {
    fn index_mut(&mut self, index: usize) -> &mut B {
        &mut self.parts_mut()[index]
    }
}

impl<B: Logic> Logic for Optional<B> {
    fn update(&mut self) {}
}

impl<B: Block> Block for Optional<B> {
    fn connect_all(&mut self) {
        self.parts_mut().iter_mut().for_each(Block::connect_all);
    }

    fn update_all(&mut self) {
        self.parts_mut().iter_mut().for_each(Block::update_all);
    }

    fn has_changed(&self) -> bool {
        self.parts().iter().any(Block::has_changed)
    }

    fn accept(&self, name: &str, probe: &mut dyn Probe) {
        self.parts().iter().for_each(|part| part.accept(&format!("{name}$0"), probe));
    }
}

impl<C: Circuit> Circuit for Optional<C> {
    fn describe(&self, key: &str, found: &mut Descriptions) {
        self.parts().iter().for_each(|part| part.describe(&format!("{key}$0"), found));
    }
}
