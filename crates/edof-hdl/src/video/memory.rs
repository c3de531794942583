//! Leaf `edof_memory`: deep block RAM.

use super::Place;
use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::board::BlockMemory;
use rust_hdl::prelude::*;

/// Block RAM with one write port and one read port. A read takes two cycles and gives what lay there before a write in the cycle of its address.
#[derive(Circuit)]
pub struct Memory<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Row to read.
    pub read_address: Signal<In, Place>,
    /// What lay there two cycles ago.
    pub read_data: Signal<Out, Bits<W>>,
    /// Whether to write.
    pub write_enable: Signal<In, Bit>,
    /// Row to write.
    pub write_address: Signal<In, Place>,
    /// Word to write.
    pub write_data: Signal<In, Bits<W>>,
    _words: Vec<Bits<W>>,
    _read: Bits<W>,
}

impl<const W: usize> Memory<W> {
    /// A memory of `rows` or more, as it suits the blocks of a part, whose contents are open at the start; the model has zeros there.
    ///
    /// # Panics
    /// More rows than addresses.
    #[must_use]
    pub fn open(blocks: &BlockMemory, rows: usize) -> Self {
        let depth = blocks.rows(rows);
        assert!(depth <= 1 << 16, "{depth} rows: an address has 16 bits");
        Self::from_parts(MemoryParts { _words: vec![0.into(); depth], _read: Bits::default() })
    }
}

impl<const W: usize> Logic for Memory<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self.read_data.next = self._read;
            let read = self.read_address.val().to_u64() as usize;
            self._read = self._words.get(read).copied().unwrap_or_default();
            let write = self.write_address.val().to_u64() as usize;
            if let (true, Some(word)) = (self.write_enable.val(), self._words.get_mut(write)) {
                *word = self.write_data.val();
            }
        }
    }

    fn connect(&mut self) {
        self.read_data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_memory")
            .parameter("WIDTH", W)
            .parameter("DEPTH", self._words.len())
            .text("INIT", "")
            .port("clock_i", "clock")
            .port("read_address_i", "read_address")
            .port("read_data_o", "read_data")
            .port("write_enable_i", "write_enable")
            .port("write_address_i", "write_address")
            .port("write_data_i", "write_data")
            .verilog()
    }
}
