//! What passes through an HDMI cable: lines of three colour channels, and the infoframe that says how to read them.

/// A length along a line (pixels) or along a frame (lines): picture, front porch, sync, back porch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axis {
    /// Picture.
    pub active: usize,
    /// From the picture to the sync.
    pub front: usize,
    /// Sync.
    pub sync: usize,
    /// From the sync to the next picture.
    pub back: usize,
}

impl Axis {
    /// All of it.
    #[must_use]
    pub const fn total(self) -> usize {
        self.active + self.front + self.sync + self.back
    }
}

/// Timing of a video mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// Along a line.
    pub line: Axis,
    /// Along a frame.
    pub frame: Axis,
    /// Pixel clock in kilohertz.
    pub khz: u32,
}

/// A progressive timing of CEA-861 or VESA DMT: along a line, along a frame, kilohertz.
const fn timing(line: [usize; 4], frame: [usize; 4], khz: u32) -> Timing {
    let [active, front, sync, back] = line;
    let line = Axis { active, front, sync, back };
    let [active, front, sync, back] = frame;
    Timing { line, frame: Axis { active, front, sync, back }, khz }
}

impl Timing {
    /// CEA-861 format 1, VESA DMT 4: 640×480 at 59.94 Hz.
    pub const VGA: Self = timing([640, 16, 96, 48], [480, 10, 2, 33], 25_175);
    /// CEA-861 format 4: 1280×720 at 60 Hz.
    pub const P720_60: Self = timing([1280, 110, 40, 220], [720, 5, 5, 20], 74_250);
    /// CEA-861 format 19: 1280×720 at 50 Hz.
    pub const P720_50: Self = timing([1280, 440, 40, 220], [720, 5, 5, 20], 74_250);
    /// CEA-861 format 16: 1920×1080 at 60 Hz.
    pub const P1080_60: Self = timing([1920, 88, 44, 148], [1080, 4, 5, 36], 148_500);
    /// CEA-861 format 31: 1920×1080 at 50 Hz.
    pub const P1080_50: Self = timing([1920, 528, 44, 148], [1080, 4, 5, 36], 148_500);
    /// CEA-861 format 34: 1920×1080 at 30 Hz.
    pub const P1080_30: Self = Self { khz: 74_250, ..Self::P1080_60 };
    /// CEA-861 format 33: 1920×1080 at 25 Hz.
    pub const P1080_25: Self = Self { khz: 74_250, ..Self::P1080_50 };
    /// CEA-861 format 32: 1920×1080 at 24 Hz.
    pub const P1080_24: Self = timing([1920, 638, 44, 148], [1080, 4, 5, 36], 74_250);

    /// Its picture and porches at the clock of another timing: what a short simulation passes in place of that one.
    #[must_use]
    pub const fn in_place_of(self, other: Self) -> Self {
        Self { khz: other.khz, ..self }
    }
}

/// How the three channels of a link carry colour (HDMI 1.4, §6.5 and table 8-3, field Y).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coding {
    /// Blue, green, red on channels 0, 1, 2.
    Rgb,
    /// 12-bit container: luma on channel 1, Cb and Cr by turns on channel 2, low bits on channel 0.
    Ycc422,
    /// Cb, Y, Cr on channels 0, 1, 2.
    Ycc444,
}

/// What an AVI infoframe says (CEA-861, as far as it changes pixels).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avi {
    /// Field Y.
    pub coding: Coding,
    /// Fields Q and YQ: the sender declares values of full range.
    pub is_full: bool,
}

/// How a link is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Link {
    /// HDMI with data islands; else DVI, which knows RGB alone.
    pub is_hdmi: bool,
    /// The infoframe, if one is sent.
    pub avi: Option<Avi>,
}

impl Link {
    /// How a receiver that follows the standards reads the channels.
    #[must_use]
    pub fn coding(self) -> Coding {
        self.avi.filter(|_| self.is_hdmi).map_or(Coding::Rgb, |avi| avi.coding)
    }
}

/// Three channels of a pixel.
pub type Pixel = [u8; 3];

/// Luma and the pair's Cb and Cr of 8 bits as R'G'B' of BT.709, limited range in, full range out.
#[must_use]
pub fn rgb_of(y: u8, cb: u8, cr: u8) -> Pixel {
    let (y, cb, cr) = (f64::from(y) - 16.0, f64::from(cb) - 128.0, f64::from(cr) - 128.0);
    let code = |luma: f64, chroma: f64| {
        (luma * 255.0 / 219.0 + chroma * 255.0 / 224.0).round().clamp(0.0, 255.0) as u8
    };
    [code(y, 1.5748 * cr), code(y, -0.187_324 * cb - 0.468_124 * cr), code(y, 1.8556 * cb)]
}

/// R'G'B' of full range as Y', Cb, Cr of BT.709, limited range.
#[must_use]
pub fn ycc_of([r, g, b]: Pixel) -> Pixel {
    let [r, g, b] = [r, g, b].map(f64::from);
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let chroma = |colour: f64, scale: f64| {
        (128.0 + (colour - y) / scale * 224.0 / 255.0).round().clamp(0.0, 255.0) as u8
    };
    [(16.0 + y * 219.0 / 255.0).round() as u8, chroma(b, 1.8556), chroma(r, 1.5748)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_there_and_back_differ_by_rounding_alone() {
        for rgb in [[0, 0, 0], [255, 255, 255], [255, 0, 0], [10, 200, 90], [128, 127, 126]] {
            let [y, cb, cr] = ycc_of(rgb);
            let back = rgb_of(y, cb, cr);
            assert!(rgb.iter().zip(back).all(|(a, b)| a.abs_diff(b) <= 2), "{rgb:?} {back:?}");
        }
        assert_eq!(ycc_of([255, 255, 255]), [235, 128, 128]);
    }
}
