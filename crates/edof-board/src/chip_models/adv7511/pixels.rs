//! From the pixel bus to the channels of a link.
//!
//! Sources: ADV7511W hardware guide table 6 (styles), Linux `adv7511_drv.c` (style codes, colour depth), ADV7511 Programming Guide §4.3 (4:2:2 to
//! 4:4:4, colour space conversion), UG810 table 1-21 (the KC705 wires D8 to D23).

use crate::chip_models::hdmi::Pixel;
use crate::chip_models::registers::Page;

/// The pixel bus in one clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Bus {
    /// Horizontal sync.
    pub hs: bool,
    /// Vertical sync.
    pub vs: bool,
    /// A pixel is on the bus.
    pub de: bool,
    /// D23 to D8.
    pub data: u16,
}

/// What leaves through the cable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A line of the picture: channels 0, 1, 2.
    Line(Vec<Pixel>),
    /// The vertical sync begins.
    Sync,
}

/// Coefficients of the colour space conversion as they are in force: 18 to 2F.
#[derive(Debug, Clone, Copy)]
pub struct Csc {
    is_on: bool,
    scale: u32,
    rows: [[i32; 4]; 3],
}

impl Csc {
    /// Those that the registers hold.
    pub(super) fn of(page: &Page) -> Self {
        // 13 bits in two's complement.
        let word = |place: u8| {
            let word = i32::from(page.get(place) & 0x1f) << 8 | i32::from(page.get(place + 1));
            (word << 19) >> 19
        };
        let row = |row: u8| std::array::from_fn(|i| word(0x18 + 8 * row + 2 * i as u8));
        Self { is_on: page.bit(0x18, 7), scale: page.bits(0x18, 6, 5).into(), rows: [row(0), row(1), row(2)] }
    }

    /// Red or Cr, green or Y, blue or Cb of 8 bits, in and out. The chip computes with 12 bits.
    fn apply(&self, colour: [u8; 3]) -> [u8; 3] {
        if !self.is_on {
            return colour;
        }
        let twelve = colour.map(|code| i32::from(code) << 4);
        self.rows.map(|[a, b, c, offset]| {
            let sum = (a * twelve[0] + b * twelve[1] + c * twelve[2]) / 4096 + offset;
            ((sum << self.scale.min(2)) >> 4).clamp(0, 255) as u8
        })
    }
}

/// Whether the registers expect what the KC705 gives: 16 bits of 4:2:2 with separate syncs (15), 8 bits a colour and a style (16),
/// right-justified (48).
pub(super) const fn fits(page: &Page) -> bool {
    page.bits(0x15, 3, 0) == 1
        && page.bits(0x16, 5, 4) == 3
        && page.bits(0x16, 3, 2) != 0
        && page.bits(0x48, 4, 3) == 1
}

/// A line as it comes in.
#[derive(Debug, Clone, Default)]
pub struct Line {
    words: Vec<u16>,
    vs: bool,
}

impl Line {
    pub(super) fn pixel(&mut self, page: &Page, csc: &Csc, bus: Bus) -> Option<Event> {
        let begins = bus.vs && !self.vs;
        self.vs = bus.vs;
        if bus.de {
            self.words.push(bus.data);
            return None;
        }
        if !self.words.is_empty() {
            let words = std::mem::take(&mut self.words);
            return Some(Event::Line(channels(page, csc, &words)));
        }
        begins.then_some(Event::Sync)
    }
}

/// Luma and chroma of a word: style 3 (code 11) has luma above, styles 1 (code 10) and 2 (01) below.
const fn split(page: &Page, word: u16) -> (u8, u8) {
    let [high, low] = word.to_be_bytes();
    if page.bits(0x16, 3, 2) == 3 { (high, low) } else { (low, high) }
}

/// The channels of a line.
fn channels(page: &Page, csc: &Csc, words: &[u16]) -> Vec<Pixel> {
    let pixels: Vec<(u8, u8)> = words.iter().map(|word| split(page, *word)).collect();
    let colours = (0..pixels.len()).map(|i| csc.apply(full_chroma(page, &pixels, i)));
    let is_422 = page.bit(0x16, 7);
    if !is_422 {
        // Channel 0 is blue or Cb.
        return colours.map(|[a, b, c]| [c, b, a]).collect();
    }
    if !csc.is_on {
        return pixels.iter().map(|(y, c)| [0, *y, *c]).collect();
    }
    let colours: Vec<[u8; 3]> = colours.collect();
    let chroma = |i: usize| if i.is_multiple_of(2) { colours[i][2] } else { colours[i - 1][0] };
    (0..colours.len()).map(|i| [0, colours[i][1], chroma(i)]).collect()
}

/// Cr, Y, Cb of a pixel: chroma of its pair repeated, or interpolated at odd pixels (17 bit 2).
fn full_chroma(page: &Page, pixels: &[(u8, u8)], i: usize) -> [u8; 3] {
    let site = i - i % 2;
    let at = |site: usize| {
        let cb = pixels[site].1;
        (cb, pixels.get(site + 1).map_or(128, |pixel| pixel.1))
    };
    let (mut cb, mut cr) = at(site);
    if page.bit(0x17, 2) && i != site && site + 2 < pixels.len() {
        let next = at(site + 2);
        let mean = |a: u8, b: u8| ((u16::from(a) + u16::from(b)) / 2) as u8;
        (cb, cr) = (mean(cb, next.0), mean(cr, next.1));
    }
    [cr, pixels[i].0, cb]
}
