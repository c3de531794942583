//! Cameras, networks and designs by name or file, with everything that they name: what a command or a script is given as a word.
//!
//! | what | module |
//! |---|---|
//! | cameras with their PSF banks and masks, depths before them | [`lens`] |
//! | networks, float and fixed; those under `weights/` are inside | [`weights`] |
//! | designs, and whether a network fits one | [`designs`] |
//!
//! ```
//! let network = edof::presets::weights::fixed(edof::presets::weights::default_for(edof_core::Tone::Srgb))?;
//! let lens = edof::presets::lens::resolve("ring-outer", None)?;
//! assert!(network.origin.camera.same_lens(&lens.camera));
//! # Ok::<(), edof::presets::PresetError>(())
//! ```
//!
//! # Stability
//!
//! Stable: names of cameras, designs and networks; a name keeps its meaning. Signatures may change between minor versions until 1.0.

pub mod designs;
pub mod lens;
pub mod weights;

use edof_core::camera::{BankError, CameraError, HeightMapError};
use edof_core::words::number;
use edof_device::design::DesignError;
use edof_io::photo::PhotoError;
use edof_network::weight_file::WeightFileError;
use edof_optics::psf::NoPsf;
use std::path::{Path, PathBuf};

/// What is there in place of a file.
fn found(name: &str) -> &'static str {
    match name {
        "" => "the name is empty",
        name if Path::new(name).is_dir() => "is a folder",
        _ => "no such file",
    }
}

/// A word that names nothing, or a file that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PresetError {
    /// No camera.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// PSFs that cannot be used.
    #[error(transparent)]
    Bank(#[from] BankError),
    /// The picture of a mask cannot be read.
    #[error(transparent)]
    Photo(#[from] PhotoError),
    /// The picture of a mask is not the one that the camera means.
    #[error(transparent)]
    HeightMap(#[from] HeightMapError),
    /// No network in the file.
    #[error(transparent)]
    WeightFile(#[from] WeightFileError),
    /// No design in the file.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// No network of that name.
    #[error("weights '{name}': {found}, no {under}, and not one of the networks that come with the program ({own})", found = found(name), under = under.display())]
    NoWeights { name: String, under: PathBuf, own: String },
    /// No design of that name.
    #[error("design '{name}': no such file, and not one of the designs that come with the program ({own})")]
    NoDesign { name: String, own: String },
    /// A distance before a camera that does not know where ψ is zero.
    #[error(
        "{}m: camera {camera} does not know the distance at which psi is 0; give it as nominal_m in its file, or where a command has it by --nominal",
        number(*metres)
    )]
    NoNominal { metres: f64, camera: String },
    /// Network and design do not fit each other.
    #[error("{file}{misfit}; {instead}")]
    Misfit { file: String, misfit: Box<DesignError>, instead: String },
    /// What is wrong with a file that another one names.
    #[error("{file}: {source}")]
    File { file: String, source: Box<PresetError> },
    /// No PSFs at a depth.
    #[error(transparent)]
    NoPsf(#[from] NoPsf),
    /// No PSFs at an end of a range.
    #[error("{range}: {source}")]
    Range { range: String, source: NoPsf },
}
