//! A screen at the end of a cable: what a viewer sees of a link.

use crate::chip_models::edid::{self, Edid};
use crate::chip_models::hdmi::{Coding, Link, Pixel, rgb_of};

/// A picture on the screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    /// How the screen read the channels.
    pub coding: Coding,
    /// Columns.
    pub width: usize,
    /// The channels, line by line.
    pub pixels: Vec<Pixel>,
    /// A screen that knows DVI alone got data islands, which some show as a coloured border.
    pub has_islands: bool,
}

impl Shown {
    /// Red, green and blue as the viewer sees them.
    #[must_use]
    pub fn rgb(&self) -> Vec<Pixel> {
        match self.coding {
            Coding::Rgb => self.pixels.iter().map(|[b, g, r]| [*r, *g, *b]).collect(),
            Coding::Ycc444 => self.pixels.iter().map(|[cb, y, cr]| rgb_of(*y, *cb, *cr)).collect(),
            Coding::Ycc422 => {
                let pairs = self.pixels.chunks(2);
                let colours = |pair: &[Pixel]| {
                    let (cb, cr) = (pair[0][2], pair.last().map_or(128, |pixel| pixel[2]));
                    pair.iter().map(|pixel| rgb_of(pixel[1], cb, cr)).collect::<Vec<_>>()
                };
                pairs.flat_map(colours).collect()
            }
        }
    }
}

/// A screen.
#[derive(Debug, Clone)]
pub struct Screen {
    is_hdmi: bool,
    /// Whether the screen is switched on; hot plug is low otherwise.
    pub is_on: bool,
    lines: Vec<Vec<Pixel>>,
    /// A vertical sync was seen, so that what follows is a whole frame.
    follows: bool,
    /// Pictures that were shown.
    pub shown: Vec<Shown>,
}

impl Screen {
    /// A television: HDMI with every coding.
    #[must_use]
    pub const fn hdmi() -> Self {
        Self { is_hdmi: true, is_on: true, lines: vec![], follows: false, shown: vec![] }
    }

    /// A monitor that knows DVI alone.
    #[must_use]
    pub const fn dvi() -> Self {
        let mut screen = Self::hdmi();
        screen.is_hdmi = false;
        screen
    }

    /// What it says of itself.
    #[must_use]
    pub fn edid(&self) -> Edid {
        edid::screen(self.is_hdmi)
    }

    /// A line of a picture came.
    pub fn line(&mut self, pixels: Vec<Pixel>) {
        if self.is_on {
            self.lines.push(pixels);
        }
    }

    /// A vertical sync came: a frame is over. Frames whose lines differ in length are no picture.
    pub fn sync(&mut self, link: Link) {
        let lines = std::mem::take(&mut self.lines);
        let width = lines.first().map_or(0, Vec::len);
        if self.is_on && self.follows && width > 0 && lines.iter().all(|line| line.len() == width) {
            let coding = if self.is_hdmi { link.coding() } else { Coding::Rgb };
            let has_islands = !self.is_hdmi && link.is_hdmi;
            self.shown.push(Shown { coding, width, pixels: lines.concat(), has_islands });
        }
        self.follows = true;
    }

    /// The signal is lost.
    pub fn dark(&mut self) {
        self.lines.clear();
        self.follows = false;
    }
}
