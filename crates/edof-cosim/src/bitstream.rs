//! The sources of a bitstream: everything that is written for a board, as one folder.

use crate::chain::folder::WORDS;
use crate::promise;
use crate::system::{self, PictureError, TableWords};
use edof_core::draw::Draw;
use edof_core::number::{InputWord, OutputWord};
use edof_core::storage::folder::{self, Contents, FolderError};
use edof_core::{CfaPhase, RawFrame, Tone};
use edof_device::Design;
use edof_device::board::{BOARDS, Board, Shell};
use edof_device::design::DesignError;
use edof_golden::display::Display;
use edof_golden::scalar;
use edof_hdl::benches::Recorded;
use edof_hdl::board::Identity;
use edof_hdl::board_project::{self, BoardProject};
use edof_hdl::project::ProjectError;
use edof_network::FixedNetwork;
use ndarray::Array2;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Windows that the test bench tries.
const TRIED: usize = 12;

/// Steps of making sources.
const STEPS: usize = 4;

/// Folders and files of a generated directory beside those of its shell.
const PARTS: [&str; 12] = [
    "rtl",
    "mem",
    "sim",
    "constraints",
    "axi4_stream",
    "files.f",
    folder::MANIFEST,
    "lint.vlt",
    "registers.md",
    "registers.rdl",
    "registers.h",
    "source_map.json",
];

/// Top of the list of files.
const LIST_HEADER: &str = "\
Files of the design, for tools that are started in this folder.
From elsewhere, tell where the memory images are: define EDOF_DIR as \"/path/to/this/folder/\".";

/// Sources that cannot be made or written.
#[derive(Debug, thiserror::Error)]
pub enum BitstreamError {
    /// Design and network do not fit each other.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// The recorded pictures cannot be computed.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The circuits cannot be printed.
    #[error(transparent)]
    Project(#[from] ProjectError),
    /// The folder is not written.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// Returns a shell of a design's board, without a name the first.
///
/// # Errors
/// [`DesignError::Lacks`]: the board has none, or none of that name.
pub fn shell(design: &Design, name: Option<&str>) -> Result<&'static Shell, DesignError> {
    let board: &'static Board = design.board;
    let found = name.map_or_else(|| board.shells.first(), |name| board.shell(name));
    let what = || name.map_or_else(|| "shell to write sources for".into(), |name| format!("shell '{name}'"));
    found.ok_or_else(|| DesignError::Lacks { board: board.name, what: what() })
}

/// The files of a folder, in memory.
#[derive(Debug, Clone)]
pub struct Sources {
    contents: Contents,
    about: Value,
    /// Modules, their bytes, memory images.
    counts: [usize; 3],
    top: &'static str,
    /// The calculator's clock.
    clock_mhz: f64,
}

impl Sources {
    /// Makes those of a design with its board's first shell; both sets of weights start with the network.
    ///
    /// # Errors
    /// Design and network do not fit each other.
    pub fn of(design: &Design, network: &FixedNetwork) -> Result<Self, BitstreamError> {
        Self::told(design, network, shell(design, None)?, |_, _, _| ())
    }

    /// Those of a design and a shell, with a call before each step: how many are done, of how many, and which is next.
    ///
    /// # Errors
    /// As [`Sources::of`].
    pub fn told(
        design: &Design,
        network: &FixedNetwork,
        shell: &Shell,
        mut told: impl FnMut(usize, usize, &str),
    ) -> Result<Self, BitstreamError> {
        let project = project(design, network, shell, &mut told)?;
        let about = json!({
            "design": design,
            "weights": { "name": network.origin.name, "float_sha256": network.float_hash, WORDS: network.origin.values },
            "top": shell.top,
        });
        let core = &project.core;
        let verilog = core.verilog.iter().map(|(_, text)| text.len()).sum();
        let counts = [core.verilog.len(), verilog, core.memory.len()];
        let mut contents = contents(&project);
        contents.insert("mem/sensor_words.mem".into(), sensor_words(network.origin.values));
        told(3, STEPS, "what the design promises");
        if let Some(page) = contents.get_mut(Path::new("README.md")) {
            *page = page.replace("@words@", words(network.origin.values)) + &promise::section(design)?;
        }
        Ok(Self { contents, about, counts, top: shell.top, clock_mhz: design.clock_mhz })
    }

    /// Paths of all files in the folder.
    pub fn names(&self) -> impl Iterator<Item = &Path> {
        self.contents.keys().map(PathBuf::as_path).chain([Path::new(folder::MANIFEST)])
    }

    /// Whether the sources of some design may have a file of that path.
    #[must_use]
    pub fn may_have(path: &Path) -> bool {
        let shells = BOARDS.iter().flat_map(|board| board.shells);
        let files = shells.flat_map(|shell| shell.files.iter().copied().flatten()).map(|(path, _)| *path);
        let first = |path: &Path| path.components().next().map(|part| part.as_os_str().to_owned());
        PARTS.into_iter().chain(files).any(|known| first(Path::new(known)) == first(path))
    }

    /// Writes them; gives the manifest.
    ///
    /// # Errors
    /// [`BitstreamError::Folder`].
    pub fn write(&self, out: &Path, force: bool) -> Result<Value, FolderError> {
        let manifest = folder::manifest(self.about.clone(), &self.contents);
        folder::write(out, self.contents.clone(), &manifest, force)?;
        Ok(manifest)
    }

    /// What was written where, in words.
    #[must_use]
    pub fn summary(&self, out: &Path) -> String {
        let Self { counts: [modules, bytes, images], top, .. } = self;
        format!(
            "{}: {modules} modules ({} kB of Verilog, top {top}), {images} memory images; calculator at {} MHz",
            out.display(),
            bytes / 1000,
            self.clock_mhz
        )
    }
}

/// Returns which raw words a network of such values takes.
const fn words(values: Tone) -> &'static str {
    match values {
        Tone::Linear => "linear raw words",
        Tone::Srgb => "raw words that are encoded as sRGB first",
    }
}

/// Returns the image of `sensor_words`: the word for each value of a sensor of 12 bits, as a network of such values takes it.
fn sensor_words(values: Tone) -> String {
    let all = Array2::from_shape_fn((64, 64), |(row, column)| (64 * row + column) as u16);
    let frame = RawFrame::from_values(all, 12, CfaPhase::Rggb);
    let words = frame.map(|frame| frame.encoded(values).into_owned().into_pixels()).unwrap_or_default();
    words.iter().fold(String::new(), |mut text, word| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{word:04x}");
        text
    })
}

/// The sources, with the display tables that a board starts with and words that its benches try it with.
fn project(
    design: &Design,
    network: &FixedNetwork,
    shell: &Shell,
    told: &mut impl FnMut(usize, usize, &str),
) -> Result<BoardProject, BitstreamError> {
    design.check_network(network)?;
    let display = Display::of_network(network);
    let words = TableWords::of(&display);
    let identity = Identity::of(design, network);
    told(0, STEPS, "windows of the bench");
    let (windows, patches) = windows(design, network);
    told(1, STEPS, "pictures of the bench");
    let recorded = Recorded { windows, patches, video: system::recorded(design, network, &display)? };
    told(2, STEPS, "circuits as Verilog");
    let sets = [network, network];
    Ok(board_project::project(design, shell, sets, &identity, &words.tables(), &recorded)?)
}

/// Windows for the calculator's bench, and the patches that they become: some at the ends of their range, some of dim noise.
fn windows(design: &Design, network: &FixedNetwork) -> (Vec<Vec<InputWord>>, Vec<Vec<OutputWord>>) {
    let (draw, pixels) = (&mut Draw::new(1), design.form.window.pixels());
    let window = |i: usize| match i % 3 {
        0 => edof_device::random::extreme_window(draw, pixels),
        _ => (0..pixels).map(|_| InputWord::from_bits(draw.whole(0, 4_000) as i16)).collect(),
    };
    let windows: Vec<Vec<InputWord>> = (0..TRIED).map(window).collect();
    let patches = windows.iter().map(|window| scalar::run(network, window).output).collect();
    (windows, patches)
}

/// Every file by its path in the folder.
fn contents(project: &BoardProject) -> Contents {
    let core = &project.core;
    let verilog = core.verilog.iter().map(|(name, text)| (format!("rtl/{name}"), text.clone()));
    let names = core.verilog.iter().map(|(name, _)| format!("rtl/{name}\n"));
    let list = LIST_HEADER.lines().map(|line| format!("// {line}\n")).chain(names).collect();
    let all = verilog.chain(core.memory.iter().chain(&project.files).cloned());
    all.chain([("files.f".to_string(), list)]).map(|(path, text)| (path.into(), text)).collect()
}
