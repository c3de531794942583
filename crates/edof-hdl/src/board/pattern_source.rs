//! Raw frames that the board makes itself.

use crate::blocks::Row;
use crate::describe::{Circuit, kernel};
use crate::ports::{StreamIn, StreamOut};
use edof_device::design::FrameSize;
use edof_device::pattern::{NOISE_SEED, RAMP_COLUMN, RAMP_ROW, WORD_MASK};
use rust_hdl::prelude::*;

/// Pixels of the source, or in their place frames of a pattern (docs/contract.md, 1.3), one pixel in four cycles at most.
///
/// `select` 0 hands the source's pixels on without a register. Anything else throws them away; the pattern begins with a frame's first pixel
/// in the cycle after `select` changed from 0, and stops in the cycle after it changed back.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct PatternSource {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Begins anew.
    pub reset: Signal<In, Bit>,
    /// 0 none, 1 ramp, 2 chart, 3 noise, 4 zeros, 5 ones, 6 alternating, 7 the tile.
    pub select: Signal<In, Bits<3>>,
    /// Pixel of the tile: row (6 bits), column (6).
    pub tile_address: Signal<Out, Row>,
    /// Pixel of the tile, two cycles after its address.
    pub tile_pixel: Signal<In, Bits<16>>,
    /// The source's pixels.
    pub source: StreamIn<16>,
    /// Pixels.
    pub pixels: StreamOut<16>,
    last_column: Constant<Bits<13>>,
    last_row: Constant<Bits<13>>,
    ramp_column: Constant<Bits<16>>,
    ramp_row: Constant<Bits<16>>,
    seed: Constant<Bits<32>>,
    mask: Constant<Bits<16>>,
    #[reset(0)]
    kind: DFF<Bits<3>>,
    pause: DFF<Bits<2>>,
    column: DFF<Bits<13>>,
    row: DFF<Bits<13>>,
    line_ramp: DFF<Bits<16>>,
    ramp: DFF<Bits<16>>,
    noise: DFF<Bits<32>>,
    valid: DFF<Bit>,
    word: DFF<Bits<16>>,
    first: DFF<Bit>,
    last: DFF<Bit>,
    on: Signal<Local, Bit>,
    level: Signal<Local, Bits<4>>,
    levels: Signal<Local, Bits<16>>,
    noise_13: Signal<Local, Bits<32>>,
    noise_17: Signal<Local, Bits<32>>,
    noise_5: Signal<Local, Bits<32>>,
    next: Signal<Local, Bits<16>>,
}

impl PatternSource {
    /// For frames of a size.
    #[must_use]
    pub fn new(frame: FrameSize) -> Self {
        Self::from_parts(PatternSourceParts {
            last_column: Constant::new((frame.width as u64 - 1).into()),
            last_row: Constant::new((frame.height as u64 - 1).into()),
            ramp_column: Constant::new(u64::from(RAMP_COLUMN).into()),
            ramp_row: Constant::new(u64::from(RAMP_ROW).into()),
            seed: Constant::new(u64::from(NOISE_SEED).into()),
            mask: Constant::new(u64::from(WORD_MASK).into()),
        })
    }
}

impl Logic for PatternSource {
    #[kernel]
    fn update(&mut self) {
        self.kind.d.next = self.select.val();
        self.on.next = self.kind.q.val().any();

        // The word of this pixel.
        self.level.next = (self.column.q.val().get_bits::<4>(4) << 2)
            + self.column.q.val().get_bits::<4>(4)
            + (self.row.q.val().get_bits::<4>(4) << 1)
            + self.row.q.val().get_bits::<4>(4);
        self.levels.next = bit_cast::<16, 4>(self.level.val())
            | (bit_cast::<16, 4>(self.level.val()) << 4)
            | (bit_cast::<16, 4>(self.level.val()) << 8)
            | (bit_cast::<16, 4>(self.level.val()) << 12);
        self.noise_13.next = self.noise.q.val() ^ (self.noise.q.val() << 13);
        self.noise_17.next = self.noise_13.val() ^ (self.noise_13.val() >> 17);
        self.noise_5.next = self.noise_17.val() ^ (self.noise_17.val() << 5);
        self.tile_address.next = (bit_cast::<12, 6>(self.row.q.val().get_bits::<6>(0)) << 6)
            | bit_cast::<12, 6>(self.column.q.val().get_bits::<6>(0));
        self.next.next = self.ramp.q.val() & self.mask.val();
        if self.kind.q.val() == 2 {
            self.next.next = self.levels.val() & self.mask.val();
            if self.column.q.val().get_bit(0) && self.row.q.val().get_bit(0) {
                self.next.next = !self.levels.val() & self.mask.val();
            }
        } else if self.kind.q.val() == 3 {
            self.next.next = self.noise_5.val().get_bits::<16>(16) & self.mask.val();
        } else if self.kind.q.val() == 4 {
            self.next.next = 0.into();
        } else if self.kind.q.val() == 5 {
            self.next.next = 0xffff.into();
        } else if self.kind.q.val() == 6 {
            self.next.next = 0x5555.into();
            if self.column.q.val().get_bit(0) {
                self.next.next = 0xaaaa.into();
            }
        } else if self.kind.q.val() == 7 {
            self.next.next = self.tile_pixel.val();
        }

        // A pixel is offered until it is taken; then the tile's next one is read.
        if self.valid.q.val() {
            self.valid.d.next = !self.pixels.ready.val();
            self.pause.d.next = 0.into();
        } else if self.pause.q.val() != 2 {
            self.pause.d.next = self.pause.q.val() + 1;
        } else {
            self.valid.d.next = true;
            self.word.d.next = self.next.val();
            self.first.d.next = !self.column.q.val().any() && !self.row.q.val().any();
            self.last.d.next = self.column.q.val() == self.last_column.val();
            self.noise.d.next = self.noise_5.val();
            self.column.d.next = self.column.q.val() + 1;
            self.ramp.d.next = self.ramp.q.val() + self.ramp_column.val();
            if self.column.q.val() == self.last_column.val() {
                self.column.d.next = 0.into();
                self.row.d.next = self.row.q.val() + 1;
                self.ramp.d.next = self.line_ramp.q.val();
                self.line_ramp.d.next = self.line_ramp.q.val() + self.ramp_row.val();
                if self.row.q.val() == self.last_row.val() {
                    self.row.d.next = 0.into();
                    self.ramp.d.next = 0.into();
                    self.line_ramp.d.next = self.ramp_row.val();
                    self.noise.d.next = self.seed.val();
                }
            }
        }
        if !self.on.val() || self.reset.val() {
            self.valid.d.next = false;
            self.pause.d.next = 0.into();
            self.column.d.next = 0.into();
            self.row.d.next = 0.into();
            self.ramp.d.next = 0.into();
            self.line_ramp.d.next = self.ramp_row.val();
            self.noise.d.next = self.seed.val();
        }

        self.source.ready.next = self.pixels.ready.val() || self.on.val();
        self.pixels.valid.next = self.source.valid.val();
        self.pixels.data.next = self.source.data.val();
        self.pixels.user.next = self.source.user.val();
        self.pixels.last.next = self.source.last.val();
        if self.on.val() {
            self.pixels.valid.next = self.valid.q.val();
            self.pixels.data.next = self.word.q.val();
            self.pixels.user.next = self.first.q.val();
            self.pixels.last.next = self.last.q.val();
        }
    }
}
