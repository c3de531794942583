//! Leaf `edof_ram`: a memory with one write port and one read port.

use super::Row;
use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::design::memory::image_name;
use rust_hdl::prelude::*;

/// One write port, one read port, one clock. A read takes a cycle, with the block RAM's output register two, and gives what lay there before a write in the same cycle.
/// One without rows has no memory, and reads 0.
#[derive(Circuit)]
pub struct Ram<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Row to read.
    pub read_address: Signal<In, Row>,
    /// What lay there a cycle ago, with the output register two.
    pub read_data: Signal<Out, Bits<W>>,
    /// Whether to write.
    pub write_enable: Signal<In, Bit>,
    /// Row to write.
    pub write_address: Signal<In, Row>,
    /// Word to write.
    pub write_data: Signal<In, Bits<W>>,
    _shape: Shape,
    _memory: Vec<Bits<W>>,
    _read: Bits<W>,
}

/// Where a memory lies and what it holds at first.
#[derive(Debug, Clone)]
pub struct Shape {
    /// Rows.
    pub depth: usize,
    /// Block RAM, or LUT RAM.
    pub block: bool,
    /// With the block RAM's output register: a cycle more, and a short way out.
    pub registered: bool,
    /// Path of its image; none leaves the contents open.
    pub image: Option<String>,
}

impl Shape {
    /// LUT RAM without an image.
    #[must_use]
    pub const fn distributed(depth: usize) -> Self {
        Self { depth, block: false, registered: false, image: None }
    }

    /// Block RAM without an image.
    #[must_use]
    pub const fn block(depth: usize) -> Self {
        Self { depth, block: true, registered: false, image: None }
    }

    /// Block RAM with its output register, without an image.
    #[must_use]
    pub const fn registered(depth: usize) -> Self {
        Self { depth, block: true, registered: true, image: None }
    }
}

impl<const W: usize> Ram<W> {
    /// A memory of the given shape; its model starts with `contents`, then zeros.
    #[must_use]
    pub fn new(shape: Shape, contents: &[u64]) -> Self {
        let word = |row: usize| contents.get(row).copied().unwrap_or(0).into();
        let memory = (0..shape.depth).map(word).collect();
        Self::from_parts(RamParts { _memory: memory, _shape: shape, _read: Bits::default() })
    }
}

impl<const W: usize> Logic for Ram<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            let read = self.read_address.val().to_u64() as usize;
            let found = self._memory.get(read).copied().unwrap_or_default();
            self.read_data.next = if self._shape.registered { self._read } else { found };
            self._read = found;
            let write = self.write_address.val().to_u64() as usize;
            if let (true, Some(word)) = (self.write_enable.val(), self._memory.get_mut(write)) {
                *word = self.write_data.val();
            }
        }
    }

    fn connect(&mut self) {
        self.read_data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_ram")
            .parameter("WIDTH", W)
            .parameter("DEPTH", self._shape.depth)
            .parameter("BLOCK", usize::from(self._shape.block) + usize::from(self._shape.registered))
            .text("INIT", image_name(self._shape.image.as_deref().unwrap_or_default()))
            .port("clock_i", "clock")
            .port("read_address_i", "read_address")
            .port("read_data_o", "read_data")
            .port("write_enable_i", "write_enable")
            .port("write_address_i", "write_address")
            .port("write_data_i", "write_data")
            .verilog()
    }
}
