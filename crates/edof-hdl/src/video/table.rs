//! Leaf `edof_table`: deep block RAM that the host can look into.

use super::Place;
use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::design::memory::image_name;
use rust_hdl::prelude::*;

/// Block RAM with one read port and one port that writes or looks. Either shows two cycles after its address what lay there before a write in
/// the cycle of the address.
#[derive(Circuit)]
pub struct Table<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Row to read.
    pub read_address: Signal<In, Place>,
    /// What lay there two cycles ago.
    pub read_data: Signal<Out, Bits<W>>,
    /// Whether to write.
    pub write_enable: Signal<In, Bit>,
    /// Row to write, or to look at.
    pub address: Signal<In, Place>,
    /// Word to write.
    pub write_data: Signal<In, Bits<W>>,
    /// What lay at that row two cycles ago.
    pub data: Signal<Out, Bits<W>>,
    _image: String,
    _words: Vec<Bits<W>>,
    _read: [Bits<W>; 2],
}

impl<const W: usize> Table<W> {
    /// A table that starts with `contents`, read from `image` (`$readmemh`) in Verilog.
    #[must_use]
    pub fn loaded(image: &str, contents: &[u64]) -> Self {
        Self::from_parts(TableParts {
            _image: image.into(),
            _words: contents.iter().map(|word| (*word).into()).collect(),
            _read: Default::default(),
        })
    }
}

impl<const W: usize> Logic for Table<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            [self.read_data.next, self.data.next] = self._read;
            let rows = [self.read_address.val(), self.address.val()].map(|row| row.to_u64() as usize);
            self._read = rows.map(|row| self._words.get(row).copied().unwrap_or_default());
            if let (true, Some(word)) = (self.write_enable.val(), self._words.get_mut(rows[1])) {
                *word = self.write_data.val();
            }
        }
    }

    fn connect(&mut self) {
        self.read_data.connect();
        self.data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_table")
            .parameter("WIDTH", W)
            .parameter("DEPTH", self._words.len())
            .text("INIT", image_name(&self._image))
            .port("clock_i", "clock")
            .port("read_address_i", "read_address")
            .port("read_data_o", "read_data")
            .port("write_enable_i", "write_enable")
            .port("address_i", "address")
            .port("write_data_i", "write_data")
            .port("data_o", "data")
            .verilog()
    }
}
