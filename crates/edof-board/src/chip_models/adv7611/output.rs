//! From the channels of a link to words at the pins.
//!
//! Source: ADI UG-438 (ADV7610) page 108 and UG-237 (ADV7619) pages 101 and 119..122 for range, saturator and chroma; ADV7604 manual page 217
//! for the adjust path; EngineerZone 81937 for 00 and FF; ITU-R BT.1120 for the codes; Avnet `avnet_hdmi_in.vhd` for their place.

use super::Adv7611;
use super::maps::Map;
use crate::chip_models::hdmi::{Coding, Link, Pixel, Timing, ycc_of};

/// Luma, Cb, Cr of a pixel.
type Ycc = [u8; 3];

/// A word at the pins P15..P0.
pub type Word = u16;

/// Luma and chroma while a line is blanked (IO 05 bit 3).
const BLANK: (u8, u8) = (0x10, 0x80);
/// What it shows of its own: blue, as long as CP BF bit 2 does not choose C0..C2.
const FREE_RUN: Ycc = [0x23, 0xd4, 0x72];

/// How range is treated: IO 02.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Range {
    full_in: bool,
    full_out: bool,
    saturates: bool,
}

impl Adv7611 {
    /// The words of a line, blanking included: first the picture, then the codes that end it, the porches, the codes of the next line.
    /// `pixels` are a line of the picture, nothing in vertical blanking. `next_is_seen`: the line after this one belongs to the picture.
    #[must_use]
    pub fn line(&self, timing: Timing, link: Link, pixels: &[Pixel], next_is_seen: bool) -> Vec<Word> {
        let width = timing.line.active;
        let pairs = self.pairs(link, pixels);
        let bytes: Vec<(u8, u8)> = if self.is_free_running() {
            let [y, cb, cr] = self.own_colour();
            (0..width)
                .map(|i| if pixels.is_empty() { BLANK } else { (y, if i % 2 == 0 { cb } else { cr }) })
                .collect()
        } else if pixels.is_empty() {
            vec![BLANK; width]
        } else {
            pairs
        };
        let blanking = vec![BLANK; timing.line.total() - width];
        let mut words: Vec<Word> = bytes.into_iter().chain(blanking).map(|(y, c)| self.word(y, c)).collect();
        if self.page(Map::Io).bit(0x05, 2) {
            let total = words.len();
            self.insert(&mut words[width..width + 4], !next_is_seen, true);
            self.insert(&mut words[total - 4..], !next_is_seen, false);
        }
        words
    }

    const fn own_colour(&self) -> Ycc {
        let cp = self.page(Map::Cp);
        if cp.bit(0xbf, 2) { [cp.get(0xc0), cp.get(0xc1), cp.get(0xc2)] } else { FREE_RUN }
    }

    /// FF, 00, 00, XY on both bytes; with IO 05 bit 1 (REPL_AV_CODE) spread: FF, 00 on chroma beside 00, XY on luma.
    fn insert(&self, words: &mut [Word], vertical: bool, ends: bool) {
        let (v, h) = (u8::from(vertical), u8::from(ends));
        let xy = 0x80 | v << 5 | h << 4 | (v ^ h) << 3 | h << 2 | v << 1 | (v ^ h);
        let codes = if self.page(Map::Io).bit(0x05, 1) {
            [BLANK, BLANK, (0x00, 0xff), (xy, 0x00)]
        } else {
            [(0xff, 0xff), (0, 0), (0, 0), (xy, xy)]
        };
        for (word, (y, c)) in words.iter_mut().zip(codes) {
            *word = self.word(y, c);
        }
    }

    /// Which pins carry luma and chroma: OP_CH_SEL, IO 04 bits 7..5 (UG-180, table of output channels); only P15..P0 reach the FPGA.
    fn word(&self, y: u8, c: u8) -> Word {
        let io = self.page(Map::Io);
        if io.get(0x03) != 0x80 {
            // Another format: something, but not 16-bit 4:2:2.
            return u16::from(y ^ 0x55) << 8 | u16::from(c ^ 0xaa);
        }
        let [high, low] = match io.bits(0x04, 7, 5) {
            0b000 => [c, 0],
            0b001 => [0, c],
            0b010 => [y, 0],
            0b011 => [y, c],
            0b100 => [0, y],
            _ => [c, y],
        };
        u16::from(high) << 8 | u16::from(low)
    }

    /// Luma and chroma by turns of a line.
    fn pairs(&self, link: Link, pixels: &[Pixel]) -> Vec<(u8, u8)> {
        let is_422 = link.coding() == Coding::Ycc422;
        let colours: Vec<Ycc> =
            self.expand(link, pixels).into_iter().map(|pixel| self.process(link, pixel)).collect();
        // IO E0 bit 7: decimation without a filter for 4:4:4; for 4:2:2 the sense is reversed (UG-237 page 101).
        let filters = self.page(Map::Io).bit(0xe0, 7) == is_422;
        // IO 05 bit 0 swaps Cb and Cr.
        let swap = usize::from(self.page(Map::Io).bit(0x05, 0));
        let site = |i: usize| i - i % 2;
        let chroma = |i: usize| {
            let which = 1 + ((i % 2) ^ swap);
            let here = colours[site(i)][which];
            let before = colours[site(i).saturating_sub(1)][which];
            let after = colours[(site(i) + 1).min(colours.len() - 1)][which];
            if filters {
                ((u16::from(before) + 2 * u16::from(here) + u16::from(after) + 2) / 4) as u8
            } else {
                here
            }
        };
        (0..colours.len()).map(|i| (colours[i][0], chroma(i))).map(|(y, c)| self.protect(y, c)).collect()
    }

    /// Channels as colours of 4:4:4. The chroma of 4:2:2 is repeated, or interpolated with HDMI 1D bit 5.
    fn expand(&self, link: Link, pixels: &[Pixel]) -> Vec<Ycc> {
        let interpolates = self.page(Map::Hdmi).bit(0x1d, 5);
        let at = |i: usize| pixels.get(i).map_or(128, |pixel| pixel[2]);
        let colour = |(i, pixel): (usize, &Pixel)| match link.coding() {
            Coding::Rgb => [pixel[1], pixel[0], pixel[2]],
            Coding::Ycc444 => [pixel[1], pixel[0], pixel[2]],
            Coding::Ycc422 => {
                let pair = i - i % 2;
                let (cb, cr) = (at(pair), at(pair + 1));
                // Cr belongs to the even site; where it is interpolated it is taken for its own place in time.
                let before = if pair == 0 { cr } else { at(pair - 1) };
                let mean = ((u16::from(cr) + u16::from(before)) / 2) as u8;
                [pixel[1], cb, if interpolates { mean } else { cr }]
            }
        };
        pixels.iter().enumerate().map(colour).collect()
    }

    /// Colour space, range, adjustment, saturation.
    fn process(&self, link: Link, [first, second, third]: Ycc) -> Ycc {
        let io = self.page(Map::Io);
        let space = io.bits(0x02, 7, 4);
        let is_rgb = link.coding() == Coding::Rgb && (space == 0xf || space < 2);
        let range = self.range(link);
        // Here RGB stands as green, blue, red.
        let colour = if is_rgb && !io.bit(0x02, 1) {
            let [y, cb, cr] = ycc_of([third, first, second]);
            // The matrix gives limited range of full-range colours.
            self.scale([y, cb, cr], Range { full_in: false, ..range })
        } else {
            self.scale([first, second, third], range)
        };
        self.saturate(self.adjust(colour), range)
    }

    fn range(&self, link: Link) -> Range {
        let io = self.page(Map::Io);
        let declared = link.avi.is_some_and(|avi| avi.is_full);
        // IO 02 bits 7..4: 0 RGB limited, 1 full; 2 and 3 YCbCr 601 and 709 limited; 6 and 7 full; F by the infoframe.
        let full_in = match io.bits(0x02, 7, 4) {
            1 | 4..=7 => true,
            0xf => declared,
            _ => false,
        };
        // Bit 2 OP_656_RANGE: limited output. Bit 0 ALT_DATA_SAT turns the saturator's range round.
        let limited_out = io.bit(0x02, 2);
        Range { full_in, full_out: !limited_out, saturates: limited_out != io.bit(0x02, 0) }
    }

    fn scale(&self, [y, cb, cr]: Ycc, range: Range) -> Ycc {
        let (luma, chroma) = match (range.full_in, range.full_out) {
            (true, false) => (219.0 / 255.0, 224.0 / 255.0),
            (false, true) => (255.0 / 219.0, 255.0 / 224.0),
            _ => return [y, cb, cr],
        };
        let offset = |is_full: bool| if is_full { 0.0 } else { 16.0 };
        let code = |value: f64| value.round().clamp(0.0, 255.0) as u8;
        let scaled = |c: u8| code((f64::from(c) - 128.0) * chroma + 128.0);
        [code((f64::from(y) - offset(range.full_in)) * luma + offset(range.full_out)), scaled(cb), scaled(cr)]
    }

    /// CP 3E bit 7: luma of 12 bits times 4095/4096, chroma one less.
    fn adjust(&self, [y, cb, cr]: Ycc) -> Ycc {
        if !self.page(Map::Cp).bit(0x3e, 7) {
            return [y, cb, cr];
        }
        let luma = ((u32::from(y) << 4) * 4095 / 4096) >> 4;
        [luma as u8, cb.saturating_sub(1), cr.saturating_sub(1)]
    }

    fn saturate(&self, [y, cb, cr]: Ycc, range: Range) -> Ycc {
        if range.saturates { [y.clamp(16, 235), cb.clamp(16, 240), cr.clamp(16, 240)] } else { [y, cb, cr] }
    }

    /// 00 and FF never leave as data: they belong to the codes.
    fn protect(&self, y: u8, c: u8) -> (u8, u8) {
        (y.clamp(1, 254), c.clamp(1, 254))
    }
}
