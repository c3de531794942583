//! Leaf `edof_start`: what registers begin with.

use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::design::memory::image_name;
use rust_hdl::prelude::*;

/// Two words that nobody writes, from a memory image: what registers begin with. So the Verilog of a design is the same for every network.
#[derive(Circuit)]
pub struct Start<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The first word.
    pub first: Signal<Out, Bits<W>>,
    /// The second.
    pub second: Signal<Out, Bits<W>>,
    _image: String,
    _words: [u64; 2],
    _shown: [u64; 2],
}

impl<const W: usize> Start<W> {
    /// The words of an image, which says the same.
    #[must_use]
    pub fn new(image: String, words: [u64; 2]) -> Self {
        Self::from_parts(StartParts { _image: image, _words: words, _shown: [0; 2] })
    }
}

impl<const W: usize> Logic for Start<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._shown = self._words;
        }
        self.first.next = self._shown[0].into();
        self.second.next = self._shown[1].into();
    }

    fn connect(&mut self) {
        self.first.connect();
        self.second.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_start")
            .parameter("WIDTH", W)
            .text("INIT", image_name(&self._image))
            .port("clock_i", "clock")
            .port("first_o", "first")
            .port("second_o", "second")
            .verilog()
    }
}
