//! Whether a signal is there, and the registers that tell.
//!
//! Source: Linux `adv7604.c` (`read_cable_det`, `tdms_lock_mask`, `no_lock_cp`, `no_lock_stdi`, `read_hdmi_pixelclock`) and UG-180.

use super::Adv7611;
use super::maps::Map;
use crate::chip_models::hdmi::{Coding, Link, Timing};

/// What comes through the cable.
#[derive(Debug, Clone, Copy, Default)]
pub struct Input {
    /// The cable is in: the source's 5 V are there.
    pub is_plugged: bool,
    /// What the source sends, if it sends.
    pub signal: Option<(Timing, Link)>,
    /// Whole frames since the signal came.
    pub locked_frames: usize,
}

/// The first thing that stops a picture, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum State {
    /// The reset pin is low.
    #[error("the ADV7611 is held in reset")]
    InReset,
    /// IO 0C bit 5, 0B bits 1 and 0.
    #[error("the ADV7611 is powered down")]
    PoweredDown,
    /// IO 01 is no HDMI mode.
    #[error("the ADV7611 is not set to HDMI")]
    OtherInput,
    /// IO 15 bits 2 and 1.
    #[error("the ADV7611's clock and data pins are off")]
    PinsOff,
    /// Without 5 V.
    #[error("no cable is in the ADV7611")]
    NoCable,
    /// HDMI 83 bit 0.
    #[error("port A of the ADV7611 has no termination")]
    NoTermination,
    /// The source is dark.
    #[error("the source sends nothing")]
    NoSignal,
    /// No whole frame came yet.
    #[error("the ADV7611 has not locked yet")]
    NotLocked,
    /// CP BF bit 0.
    #[error("the ADV7611 shows its own picture")]
    FreeRun,
    /// Pixels come.
    #[error("the ADV7611 receives")]
    Runs,
}

impl Adv7611 {
    /// Sets what is in the chip's cable now.
    pub fn see(&mut self, is_plugged: bool, signal: Option<(Timing, Link)>) {
        if self.input.signal.is_none() || signal.is_none() {
            self.input.locked_frames = 0;
        }
        (self.input.is_plugged, self.input.signal) = (is_plugged, signal);
    }

    /// A whole frame came.
    pub fn frame(&mut self) {
        self.input.locked_frames = if self.hears() { self.input.locked_frames + 1 } else { 0 };
    }

    /// Whether its TMDS PLL has a clock.
    fn hears(&self) -> bool {
        let terminates = !self.page(Map::Hdmi).bit(0x83, 0);
        self.input.signal.is_some() && terminates && !self.is_powered_down()
    }

    fn is_powered_down(&self) -> bool {
        let io = self.page(Map::Io);
        self.is_reset() || io.bit(0x0c, 5) || io.bits(0x0b, 1, 0) != 0
    }

    fn is_locked(&self) -> bool {
        self.hears() && self.input.locked_frames > 0
    }

    /// The first thing that stops a picture.
    #[must_use]
    pub fn state(&self) -> State {
        let (io, hdmi) = (self.page(Map::Io), self.page(Map::Hdmi));
        let steps = [
            (self.is_reset(), State::InReset),
            (self.is_powered_down(), State::PoweredDown),
            (!matches!(io.bits(0x01, 3, 0), 5 | 6), State::OtherInput),
            (io.bits(0x15, 2, 1) != 0, State::PinsOff),
            (!self.input.is_plugged, State::NoCable),
            (hdmi.bit(0x83, 0), State::NoTermination),
            (self.input.signal.is_none(), State::NoSignal),
            (!self.is_locked(), State::NotLocked),
            (self.page(Map::Cp).bit(0xbf, 0), State::FreeRun),
        ];
        steps.into_iter().find(|(stops, _)| *stops).map_or(State::Runs, |(_, state)| state)
    }

    /// Whether the receiver shows its free-run picture: CP BA bit 0, without an input, or CP BF bit 0.
    #[must_use]
    pub fn is_free_running(&self) -> bool {
        let cp = self.page(Map::Cp);
        cp.bit(0xbf, 0) || (cp.bit(0xba, 0) && !self.is_locked())
    }

    /// The timing of its free run, by video standard (IO 00 bits 5..0), vertical frequency (IO 01 bits 6..4) and primary mode (IO 01 bits
    /// 3..0); none where no source says what these values give.
    ///
    /// Source: Linux `adv7604.c`, tables `adv76xx_prim_mode_hdmi_comp` (mode 5) and `adv76xx_prim_mode_hdmi_gr` (mode 6).
    #[must_use]
    pub const fn free_run(&self) -> Option<Timing> {
        let io = self.page(Map::Io);
        match (io.bits(0x01, 3, 0), io.bits(0x00, 5, 0), io.bits(0x01, 6, 4)) {
            (5, 0x13, 0) => Some(Timing::P720_60),
            (5, 0x13, 1) => Some(Timing::P720_50),
            (5, 0x1e, 0) => Some(Timing::P1080_60),
            (5, 0x1e, 1) => Some(Timing::P1080_50),
            (5, 0x1e, 2) => Some(Timing::P1080_30),
            (5, 0x1e, 3) => Some(Timing::P1080_25),
            (5, 0x1e, 4) => Some(Timing::P1080_24),
            (6, 0x08, 0) => Some(Timing::VGA),
            _ => None,
        }
    }

    /// The pixel clock that leaves the chip, in kilohertz: that of the cable, or of its free run; 0 where there is none.
    #[must_use]
    pub fn clock_khz(&self) -> u32 {
        let timing = match self.input.signal {
            _ if self.is_powered_down() || self.page(Map::Io).bit(0x15, 2) => None,
            Some((timing, _)) if self.hears() => Some(timing),
            _ => self.free_run().filter(|_| self.is_free_running()),
        };
        timing.map_or(0, |timing| timing.khz)
    }

    /// Whether the pixel clock leaves the chip.
    #[must_use]
    pub fn clock_runs(&self) -> bool {
        self.clock_khz() > 0
    }

    /// The value of a status register; none where the register is not one.
    pub(super) fn status(&self, map: Map, register: u8) -> Option<u8> {
        let (hears, locked) = (self.hears(), self.is_locked());
        let bit = |place: u8, is_set: bool| u8::from(is_set) << place;
        Some(match (map, register) {
            (Map::Io, 0x12) => bit(0, !locked),
            (Map::Io, 0x60) => bit(0, hears && self.link().is_some_and(|link| link.avi.is_some())),
            (Map::Io, 0x6a) => bit(4, hears) | bit(6, hears) | bit(1, locked) | bit(0, locked),
            (Map::Io, 0x6f) => bit(0, self.input.is_plugged),
            (Map::Ksv, 0x76) => self.page(Map::Ksv).get(0x74) & 3,
            (Map::Hdmi, 0x04) => bit(1, hears),
            (Map::Hdmi, 0x05) => bit(7, hears && self.link().is_some_and(|link| link.is_hdmi)),
            (Map::Hdmi, 0x07..=0x0a) => self.size(register),
            (Map::Hdmi, 0x0b) => 0,
            (Map::Hdmi, 0x51 | 0x52) => self.frequency()[usize::from(register - 0x51)],
            (Map::Hdmi, 0x53) => self.colour_space(),
            (Map::Cp, 0xb1) => bit(7, locked),
            (Map::Cp, 0xff) => bit(4, self.is_free_running()),
            (Map::Io, 0xff | 0x44 | 0x62 | 0x67 | 0x6c | 0x71) => 0,
            _ => return None,
        })
    }

    fn link(&self) -> Option<Link> {
        self.input.signal.map(|(_, link)| link)
    }

    /// HDMI 07..0A: locks, width, height.
    fn size(&self, register: u8) -> u8 {
        let locked = u8::from(self.is_locked());
        let size = self.input.signal.filter(|_| self.is_locked());
        let (width, height) = size.map_or((0, 0), |(timing, _)| (timing.line.active, timing.frame.active));
        match register {
            0x07 => locked << 7 | locked << 5 | (width >> 8) as u8 & 0x1f,
            0x08 => width as u8,
            0x09 => (height >> 8) as u8 & 0x1f,
            _ => height as u8,
        }
    }

    /// HDMI 51, 52: megahertz in nine bits, then 1/128.
    fn frequency(&self) -> [u8; 2] {
        let khz = self.input.signal.filter(|_| self.hears()).map_or(0, |(timing, _)| timing.khz);
        let (whole, part) = (khz / 1000, khz % 1000 * 128 / 1000);
        [(whole >> 1) as u8, ((whole & 1) << 7 | part) as u8]
    }

    /// HDMI 53 bits 3..0: 0 and 1 RGB limited and full, 3 YCbCr 709, 7 the same of full range.
    fn colour_space(&self) -> u8 {
        let avi = self.link().and_then(|link| link.avi).filter(|_| self.hears());
        match avi.map(|avi| (avi.coding, avi.is_full)) {
            None | Some((Coding::Rgb, false)) => 0,
            Some((Coding::Rgb, true)) => 1,
            Some((_, false)) => 3,
            Some((_, true)) => 7,
        }
    }
}
