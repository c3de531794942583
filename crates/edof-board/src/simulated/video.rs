//! The frames that go round in a simulated board, and the pictures that they become.

use edof_core::RawFrame;
use edof_core::display::{COLOUR_ADDRESS_BITS, DisplayMode, LUMA_ENTRIES};
use edof_device::design::reading::{TABLE_ENTRIES, TABLE_ROWS, table_bank};
use edof_golden::display::DisplayCounts;
use edof_golden::trace::Counts;
use edof_golden::{ColourTable, Display, Golden, LumaTable};
use edof_network::FixedNetwork;
use std::sync::Arc;

/// A picture as the screen shows it: a word a pixel, Y′ low, Cb′ or Cr′ high.
pub type Pixels = Arc<Vec<u16>>;

/// What a raw frame became.
#[derive(Debug, Clone)]
pub struct Made {
    /// The picture.
    pub pixels: Pixels,
    /// Counters of the stages.
    pub counts: Counts,
    /// Of the display step.
    pub shown: DisplayCounts,
}

/// The tables of the display step, as a host writes them.
#[derive(Debug, Clone)]
pub struct Tables {
    luma: Vec<u8>,
    colours: [Vec<u16>; 3],
}

impl Tables {
    /// Those of a display.
    #[must_use]
    pub fn of(display: &Display) -> Self {
        let colours = display.colours.each_ref().map(|table| table.entries().to_vec());
        Self { luma: display.luma.entries().to_vec(), colours }
    }

    /// Writes entry `index` of all tables one after the other.
    pub fn write(&mut self, index: usize, word: u32) {
        let (table, entry) = (index / LUMA_ENTRIES, index % LUMA_ENTRIES);
        match table {
            0 => self.luma[entry] = word as u8,
            _ if entry < 1 << COLOUR_ADDRESS_BITS => self.colours[table - 1][entry] = (word & 0xfff) as u16,
            _ => {}
        }
    }

    /// A row of four entries at a bank of a table (`edof_device::design::reading`), as the circuit reads it back.
    #[must_use]
    pub fn row(&self, bank: usize, row: usize) -> u64 {
        let (table, half) = (bank / table_bank(1) % 4, bank % table_bank(1));
        let entry = |i: usize| {
            let entry = (half * TABLE_ROWS + row) * TABLE_ENTRIES + i;
            match table {
                0 => u64::from(self.luma[entry % LUMA_ENTRIES]),
                _ => u64::from(self.colours[table - 1][entry % (1 << COLOUR_ADDRESS_BITS)]),
            }
        };
        (0..TABLE_ENTRIES).map(|i| entry(i) << (16 * i)).sum()
    }

    /// The display, none where a table holds what no display has.
    #[must_use]
    pub fn display(&self, mode: DisplayMode) -> Option<Display> {
        let luma = LumaTable::from_entries(self.luma.clone()).ok()?;
        let [red, green, blue] = self.colours.each_ref().map(|t| ColourTable::from_entries(t.clone()).ok());
        Some(Display { mode, luma, colours: [red?, green?, blue?] })
    }
}

/// The picture of a raw frame, none where the network or the frame cannot be used.
#[must_use]
pub fn made(network: FixedNetwork, display: &Display, raw: &RawFrame) -> Option<Made> {
    let frame = Golden::new(network).ok()?.frame(raw).ok()?;
    let (picture, shown) = frame.picture(display);
    let word = |bytes: &[u8]| u16::from_le_bytes([bytes[0], bytes[1]]);
    let pixels = picture.yuyv().chunks_exact(2).map(word).collect();
    Some(Made { pixels: Arc::new(pixels), counts: frame.counts, shown })
}
