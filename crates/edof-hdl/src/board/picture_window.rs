//! The host's window to pictures: a tile of raw pixels that it writes, a part of the codes that it reads.

use crate::blocks::Row;
use crate::blocks::ram::{Ram, Shape};
use crate::describe::{Circuit, kernel};
use edof_device::pattern::TILE_PIXELS;
use rust_hdl::prelude::*;

/// A square of 64 × 64 raw pixels that the host writes and a pattern repeats, and a square of as many codes of every picture, which the host
/// reads. It only looks: nothing waits for it.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct PictureWindow {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The next pixel of codes is a frame's first.
    pub reset: Signal<In, Bit>,
    /// Pixel of the tile: row (6 bits), column (6).
    pub tile_address: Signal<In, Row>,
    /// Pixel of the tile, two cycles after its address.
    pub tile_pixel: Signal<Out, Bits<16>>,
    /// Writes a pixel of the tile.
    pub write: Signal<In, Bit>,
    /// Pixel of the tile to write: row (6 bits), column (6).
    pub write_address: Signal<In, Row>,
    /// Raw pixel word.
    pub write_data: Signal<In, Bits<16>>,
    /// A pixel of codes passes in this cycle.
    pub valid: Signal<In, Bit>,
    /// Codes of the pixel.
    pub data: Signal<In, Bits<16>>,
    /// The pixel is the first of its frame.
    pub user: Signal<In, Bit>,
    /// The pixel is the last of its line.
    pub last: Signal<In, Bit>,
    /// Column (bits 12 to 0) and row (28 to 16) of the first pixel that is kept.
    pub corner: Signal<In, Bits<32>>,
    /// Pixel that is read: row (6 bits), column (6).
    pub read_address: Signal<In, Row>,
    /// Codes of the pixel that is read, two cycles after its address.
    pub read_data: Signal<Out, Bits<16>>,
    tile: Ram<16>,
    picture_words: Ram<16>,
    #[reset(false)]
    valid_1: DFF<Bit>,
    data_1: DFF<Bits<16>>,
    #[reset(0)]
    column: DFF<Bits<13>>,
    #[reset(0)]
    row: DFF<Bits<13>>,
    #[reset(false)]
    valid_2: DFF<Bit>,
    data_2: DFF<Bits<16>>,
    column_offset: DFF<Bits<13>>,
    row_offset: DFF<Bits<13>>,
    #[reset(false)]
    ends: DFF<Bit>,
}

impl PictureWindow {
    /// The window of any board.
    #[must_use]
    pub fn new() -> Self {
        let shape = || Shape::registered(TILE_PIXELS);
        Self::from_parts(PictureWindowParts {
            tile: Ram::new(shape(), &[]),
            picture_words: Ram::new(shape(), &[]),
        })
    }
}

impl Default for PictureWindow {
    fn default() -> Self {
        Self::new()
    }
}

impl Logic for PictureWindow {
    #[kernel]
    fn update(&mut self) {
        self.tile.clock.next = self.clock.val();
        self.tile.read_address.next = self.tile_address.val();
        self.tile_pixel.next = self.tile.read_data.val();
        self.tile.write_enable.next = self.write.val();
        self.tile.write_address.next = self.write_address.val();
        self.tile.write_data.next = self.write_data.val();

        // Where a pixel is.
        self.valid_1.d.next = self.valid.val();
        self.data_1.d.next = self.data.val();
        if self.valid.val() {
            self.ends.d.next = self.last.val();
            self.column.d.next = self.column.q.val() + 1;
            if self.ends.q.val() {
                self.column.d.next = 0.into();
                self.row.d.next = self.row.q.val() + 1;
            }
            if self.user.val() {
                self.column.d.next = 0.into();
                self.row.d.next = 0.into();
            }
        }
        // And from the corner that is kept.
        self.valid_2.d.next = self.valid_1.q.val();
        self.data_2.d.next = self.data_1.q.val();
        self.column_offset.d.next = self.column.q.val() - self.corner.val().get_bits::<13>(0);
        self.row_offset.d.next = self.row.q.val() - self.corner.val().get_bits::<13>(16);
        self.picture_words.clock.next = self.clock.val();
        self.picture_words.write_enable.next = self.valid_2.q.val()
            && !self.column_offset.q.val().get_bits::<7>(6).any()
            && !self.row_offset.q.val().get_bits::<7>(6).any();
        self.picture_words.write_address.next = (bit_cast::<12, 6>(self.row_offset.q.val().get_bits::<6>(0))
            << 6)
            | bit_cast::<12, 6>(self.column_offset.q.val().get_bits::<6>(0));
        self.picture_words.write_data.next = self.data_2.q.val();
        self.picture_words.read_address.next = self.read_address.val();
        self.read_data.next = self.picture_words.read_data.val();
    }
}
