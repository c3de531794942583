//! The board in `edof demo`: the sources of its bitstream, and a crop of the coded lens's frame through its Verilog, from pins to pins.

use crate::cosim_system::{self, BESIDES};
use crate::designs;
use crate::error::Error;
use crate::ui::Ui;
use edof_core::cable::carried;
use edof_core::{ColourFrame, RawFrame, Tone};
use edof_cosim::bitstream::Sources;
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::{Display, Golden};
use edof_network::FixedNetwork;
use edof_study::pictures;
use edof_study::report::picture::{enlarged, png};
use edof_study::report::{Figure, Layout, Report};
use ndarray::s;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Folder of the sources, in the demo's.
pub const FOLDER: &str = "board";
/// Rows and columns of the crop: it takes seconds, and is more than a few patches.
const SIDE: usize = 64;
/// The same picture is sent so often that it is on the screen once.
const TIMES: usize = 1 + BESIDES;
/// What simulates its Verilog.
const SIMULATOR: &str = "verilator";
/// Each pixel of the crop is shown so large.
const ENLARGED: usize = 4;

/// A board with a network.
pub struct Board {
    design: Design,
    network: FixedNetwork,
    sources: Sources,
}

/// What became of the crop.
enum Tried {
    /// The screen showed the golden picture.
    Shown { picture: ColourFrame, seconds: f64 },
    /// The circuit was not simulated; the Rust model, which computes the same words, shows the picture.
    Modelled { picture: ColourFrame, why: String },
    /// The simulation was not tried.
    LeftOut(String),
}

/// What the demo reports of its board.
pub struct Told {
    summary: String,
    design: String,
    tried: Tried,
}

impl Board {
    /// The board of a design that the user `given` named so.
    ///
    /// # Errors
    /// Design and network do not fit each other.
    pub fn of(design: Design, given: &str, network: FixedNetwork) -> Result<Self, Error> {
        designs::fits_given(&design, given, &network)?;
        let sources = Sources::of(&design, &network)?;
        Ok(Self { design, network, sources })
    }

    /// What is written into the demo's folder.
    pub fn names(&self) -> impl Iterator<Item = PathBuf> {
        self.sources.names().map(|name| Path::new(FOLDER).join(name))
    }

    /// Writes the sources into the demo's folder, and tries their Verilog with the busiest part of a raw frame.
    ///
    /// # Errors
    /// A folder that cannot be written, no picture, or one that is not golden. A simulator that is missing is none.
    pub fn tell(&self, raw: &RawFrame, out: &Path, ui: &Ui) -> Result<Told, Error> {
        let folder = out.join(FOLDER);
        self.sources.write(&folder, false).map_err(Error::of_folder)?;
        let (summary, design) = (self.sources.summary(&folder), self.design.name.clone());
        ui.note(&summary);
        let tried = self.tried(raw, ui)?;
        Ok(Told { summary, design, tried })
    }

    fn tried(&self, raw: &RawFrame, ui: &Ui) -> Result<Tried, Error> {
        let (height, width) = raw.size();
        if height < SIDE || width < SIDE {
            return Ok(Tried::LeftOut(format!(
                "the picture is smaller than the {SIDE}x{SIDE} pixels that are simulated"
            )));
        }
        let frame = FrameSize { width: SIDE, height: SIDE, ..self.design.frame };
        let design = Design { frame, ..self.design.clone() };
        let crop = cosim_system::crop(raw, busiest_part(raw), frame)?;
        let (values, start) = (self.network.origin.values, Instant::now());
        let (display, crop) = (Display::of_network(&self.network), crop.encoded(values).into_owned());
        let golden = Golden::new(self.network.clone())?;
        let picture = golden.frame(&carried(&crop))?.picture(&display).0.shown_frame();
        if let Err(error) = edof_cosim::tool::require(SIMULATOR).map_err(Error::from) {
            let tool = error.missing_tool().map(str::to_owned).ok_or(error)?;
            let why = format!("{tool} is not installed, so that its Verilog was not simulated");
            return Ok(Tried::Modelled { picture, why });
        }
        let passed = cosim_system::through(&design, &self.network, &display, &vec![crop; TIMES], 1, ui)?;
        if passed.in_a_row() == 0 {
            return Err(Error::message(format!(
                "{}: none of {TIMES} frames that its Verilog took was on the screen, expected one",
                self.design.name
            )));
        }
        Ok(Tried::Shown { picture, seconds: start.elapsed().as_secs_f64() })
    }
}

/// Row and column of the part in which neighbours of one colour differ most: the middle where the frame is too small to choose.
fn busiest_part(raw: &RawFrame) -> (usize, usize) {
    let one_colour = raw.values().slice(s![..;2, ..;2]).mapv(f32::from);
    let (height, width) = raw.size();
    let middle = |length: usize| (length - SIDE) / 4 * 2;
    pictures::busiest_part(&one_colour, SIDE / 2)
        .map_or((middle(height), middle(width)), |(row, column)| (2 * row, 2 * column))
}

impl Told {
    /// In a terminal.
    pub fn to_text(&self) -> String {
        format!("{}\n{}: {}", self.summary, self.design, self.tried())
    }

    fn tried(&self) -> String {
        match &self.tried {
            Tried::Shown { seconds, .. } => format!(
                "{SIDE}x{SIDE} pixels through its Verilog, from HDMI in through DRAM to HDMI out: every code as golden ({seconds:.0} s)"
            ),
            Tried::Modelled { why, .. } => {
                format!("{why}; {SIDE}x{SIDE} pixels through the Rust model, which computes the same words")
            }
            Tried::LeftOut(why) => why.clone(),
        }
    }

    /// As data.
    pub fn to_json(&self) -> Value {
        match &self.tried {
            Tried::Shown { seconds, .. } => {
                json!({ "design": self.design, "crop": [SIDE, SIDE], "differences": 0, "seconds": seconds })
            }
            Tried::Modelled { why, .. } => {
                json!({ "design": self.design, "crop": [SIDE, SIDE], "modelled": true, "not_simulated": why })
            }
            Tried::LeftOut(why) => json!({ "design": self.design, "not_simulated": why }),
        }
    }

    /// At the end of the demo's report.
    ///
    /// # Errors
    /// A picture that cannot be encoded.
    pub fn add_to(&self, report: &mut Report) -> Result<(), Error> {
        report.heading("The board");
        report.paragraph(&format!(
            "The sources of its bitstream are beside this page. {}. {}.",
            self.summary,
            self.tried()
        ));
        let (title, picture) = match &self.tried {
            Tried::Shown { picture, .. } => (format!("What the simulated {} shows", self.design), picture),
            Tried::Modelled { picture, .. } => {
                (format!("What the Rust model of {} shows", self.design), picture)
            }
            Tried::LeftOut(_) => return Ok(()),
        };
        let figure = Figure {
            title,
            note: format!("the busiest {SIDE}×{SIDE} pixels of the coded lens's frame, enlarged"),
            // Already encoded.
            picture: png(&enlarged(picture, ENLARGED), Tone::Linear)?,
        };
        report.figures(&[figure], Layout::Wide);
        Ok(())
    }
}
