//! Leaf `edof_crc`: the CRC-32 of a frame of beats.

use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::crc::POLYNOMIAL;
use rust_hdl::prelude::*;

/// CRC of 32 bits (`edof_device::crc`) of the beats since the first one, the lowest bit of a beat first; valid a cycle after the last one's `valid`.
/// A beat has as many bits of `data` as the circuit was made for, the low ones.
#[derive(Circuit)]
pub struct Crc {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// There was a beat in the cycle before.
    pub valid: Signal<In, Bit>,
    /// The beat of the cycle before was the first of its frame.
    pub first: Signal<In, Bit>,
    /// A beat, if there is one.
    pub data: Signal<In, Bits<32>>,
    /// The CRC of all beats so far.
    pub crc: Signal<Out, Bits<32>>,
    _width: usize,
    _crc: u32,
    _beat: u64,
}

impl Crc {
    /// CRC of beats of `width` bits, 32 at most.
    #[must_use]
    pub fn new(width: usize) -> Self {
        assert!((1..=32).contains(&width), "a beat has 1 to 32 bits");
        Self::from_parts(CrcParts { _width: width, _crc: 0, _beat: 0 })
    }
}

impl Logic for Crc {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            if self.valid.val() {
                let before = if self.first.val() { !0 } else { self._crc };
                self._crc = (0..self._width).fold(before, |crc, bit| {
                    let is_odd = (crc ^ (self._beat >> bit) as u32) & 1;
                    (crc >> 1) ^ (POLYNOMIAL & is_odd.wrapping_neg())
                });
            }
            self._beat = self.data.val().to_u64();
        }
        self.crc.next = u64::from(!self._crc).into();
    }

    fn connect(&mut self) {
        self.crc.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_crc")
            .parameter("WIDTH", self._width)
            .port("clock_i", "clock")
            .port("valid_i", "valid")
            .port("first_i", "first")
            .port("data_i", "data")
            .port("crc_o", "crc")
            .verilog()
    }
}
