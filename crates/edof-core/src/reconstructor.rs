//! The contract that every reconstruction method fulfils: a raw frame in, a colour frame out, with the time and work it took.

use crate::frame::{ColourFrame, RawFrame};
use crate::geometry::GeometryError;
use crate::tone::Tone;
use crate::words::count;
use serde::Serialize;
use std::borrow::Cow;
use std::time::Instant;

/// What a method made of a raw frame, and what it cost.
#[derive(Debug, Clone)]
pub struct Reconstruction {
    /// The colour frame, linear light, as large as the raw frame.
    pub frame: ColourFrame,
    /// Wall-clock seconds, without reading and writing files.
    pub seconds: f64,
    /// Multiplications that it took, where the method counts them.
    pub multiplications: Option<Multiplications>,
    /// What the method's counters say, where it has some.
    pub counters: Option<Counters>,
    /// Steps of an iterative method, mean over patches or colours; a network has layers instead.
    pub iterations: Option<f64>,
}

/// Counters of a fixed-point network for a whole frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Counters {
    /// Patches reconstructed.
    pub patches: u64,
    /// Words that were not zero after each shrinkage, all patches together.
    pub nonzeros: Vec<u64>,
    /// Words of all stages and overlap sums that did not fit.
    pub saturations: u64,
}

/// Multiplications of a weight by a word or number, for a whole frame; each is added to a sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Multiplications {
    /// Those of a machine that multiplies every weight: patches × `Form::dense_multiplications` of the network.
    pub dense: u64,
    /// Those that were carried out; fewer where zero sparse codes are skipped.
    pub executed: u64,
}

/// A frame that a method cannot reconstruct.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum ReconstructError {
    /// Odd or too small.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Too few or too many frames.
    #[error("{method}: got {} of one scene, expected {expected}", count(*.found, "raw frame"))]
    Exposures { method: String, found: usize, expected: usize },
    /// Anything else, in one line.
    #[error("{method}: {reason}")]
    Method { method: String, reason: String },
}

impl ReconstructError {
    /// Too few or too many frames of a scene.
    #[must_use]
    pub fn exposures(method: &str, found: usize, expected: usize) -> Self {
        Self::Exposures { method: method.to_owned(), found, expected }
    }
}

impl Reconstruction {
    /// What a method makes of a frame of light whose own values are of a tone: `run` gets the frame encoded, and its picture is decoded.
    ///
    /// # Errors
    /// Those of `run`.
    pub fn through<E>(
        values: Tone,
        raw: &RawFrame,
        run: impl FnOnce(&RawFrame) -> Result<Self, E>,
    ) -> Result<Self, E> {
        Self::through_exposures(values, &[raw], |encoded| run(&encoded[0]))
    }

    /// The same for several frames of one scene.
    ///
    /// # Errors
    /// Those of `run`.
    pub fn through_exposures<E>(
        values: Tone,
        raws: &[&RawFrame],
        run: impl FnOnce(&[Cow<'_, RawFrame>]) -> Result<Self, E>,
    ) -> Result<Self, E> {
        let start = Instant::now();
        let encoded: Vec<Cow<'_, RawFrame>> = raws.iter().map(|raw| raw.encoded(values)).collect();
        let before = start.elapsed().as_secs_f64();
        let mut made = run(&encoded)?;
        let start = Instant::now();
        values.lighten(&mut made.frame);
        made.seconds += before + start.elapsed().as_secs_f64();
        Ok(made)
    }
}

/// A method that turns raw frames into colour frames.
pub trait Reconstructor: Sync {
    /// Name in reports, as in `edof-t4w12.fixed`.
    fn name(&self) -> &str;

    /// Reconstructs one frame of any CFA phase.
    ///
    /// # Errors
    /// [`ReconstructError`] for frames of sides that the method cannot take.
    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError>;

    /// Reconstructs a scene from its exposures; one, unless the method is a network of several.
    ///
    /// # Errors
    /// As [`Reconstructor::reconstruct`], and [`ReconstructError::Exposures`].
    fn reconstruct_exposures(&self, raws: &[&RawFrame]) -> Result<Reconstruction, ReconstructError> {
        match raws {
            [raw] => self.reconstruct(raw),
            _ => Err(ReconstructError::exposures(self.name(), raws.len(), 1)),
        }
    }
}
