//! A PC's graphics card: what it makes of greys on their way to the cable.
//!
//! Sources: Linux `drivers/gpu/drm/i915/display/intel_color.c` for the gains of limited range, in steps of 1/512, and its offsets, in steps of
//! 1/4096 (`ILK_CSC_COEFF_LIMITED_RANGE`, `ILK_CSC_POSTOFF_LIMITED_RANGE`, each in two revisions); CEA-861 for the nominal ranges; ITU-R BT.601
//! and BT.709 for luma, which is the same of a grey. Whether a card rounds or cuts fractions off is not stated: both are here.

use crate::chip_models::hdmi::{Avi, Coding, Link, Pixel};

/// How a card makes the codes of a channel of a grey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    /// Out of in, both from 0 to 1.
    pub gain: f64,
    /// Code of black.
    pub offset: f64,
    /// Fractions are cut off; else rounded.
    pub cuts: bool,
}

impl Scaling {
    /// Codes as they are drawn: full range.
    pub const NONE: Self = Self { gain: 1.0, offset: 0.0, cuts: false };
    /// 0 to 255 become 16 to 235.
    pub const LIMITED: Self = Self { gain: 219.0 / 255.0, offset: 16.0 / 255.0, cuts: false };
    /// The same with the older coefficients of i915: 440/512 and 257/4096.
    pub const I915_OLD: Self = Self { gain: 440.0 / 512.0, offset: 257.0 / 4096.0, cuts: true };
    /// And the newer ones: 438/512 and 256/4096.
    pub const I915: Self = Self { gain: 438.0 / 512.0, offset: 256.0 / 4096.0, cuts: true };

    /// The code of a code.
    #[must_use]
    pub fn code(self, grey: u8) -> u8 {
        let exact = (f64::from(grey) / 255.0).mul_add(self.gain, self.offset) * 255.0;
        let code = if self.cuts { exact.floor() } else { exact.round() };
        code.clamp(0.0, 255.0) as u8
    }
}

/// A card that sends greys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraphicsCard {
    /// Changes of the codes, one after the other: by a player, by the card.
    pub scalings: &'static [Scaling],
    /// RGB, or luma with chroma 128 for each pixel.
    pub coding: Coding,
}

impl GraphicsCard {
    /// How it runs the link.
    #[must_use]
    pub const fn link(&self) -> Link {
        Link { is_hdmi: true, avi: Some(Avi { coding: self.coding, is_full: false }) }
    }

    /// The channels of a line of greys.
    #[must_use]
    pub fn line(&self, greys: &[u8]) -> Vec<Pixel> {
        let code = |grey: &u8| self.scalings.iter().fold(*grey, |code, scaling| scaling.code(code));
        let pixel = |code: u8| match self.coding {
            Coding::Rgb => [code; 3],
            Coding::Ycc444 => [128, code, 128],
            Coding::Ycc422 => [0, code, 128],
        };
        greys.iter().map(code).map(pixel).collect()
    }
}
