//! From a raw frame in a file, or from the exposures of a scene, to a picture in a file.

mod exposures;
mod frame;
mod suits;

pub use frame::FrameSource;

use super::device::Device;
use super::npz::Npz;
use super::{FrameNote, JobError};
use crate::presets::weights;
use edof_core::camera::Camera;
use edof_core::overlap::Overlap;
use edof_core::reconstructor::Multiplications;
use edof_core::storage::atomic;
use edof_core::storage::provenance::Input;
use edof_core::{ColourFrame, DisplayMode, Frame422, Noise, RawFrame, Reconstructor, Stride, Tone, cable};
use edof_deblur::Demosaicing;
use edof_golden::words::Boundary;
use edof_golden::{Counts, Curve, Display, DisplayCounts, Golden, Picture};
use edof_gpu::{GpuFloat, GpuGolden};
use edof_io::photo::{self, PhotoError};
use edof_io::picture::{self, Format};
use edof_io::transfer::Statement;
use edof_network::FixedNetwork;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use frame::Taken;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A reconstruction: which frame, by which network or demosaicing, and which files are written.
#[derive(Debug, Clone)]
pub struct ReconstructJob {
    /// The raw frame; for a network of several exposures, the first of the scene.
    pub source: FrameSource,
    /// The raw frames of the scene's further exposures.
    pub further: Vec<FrameSource>,
    /// Name or file of the network; by default the one for the frame's tone and noise.
    pub network: Option<String>,
    /// Whether a network that was trained for another lens is used.
    pub accepts_any_lens: bool,
    /// How the picture is computed.
    pub engine: Engine,
    /// What computes the network.
    pub device: Device,
    /// Transfer curve of the picture and of the board's tables; by default that of the tone.
    pub curve: Option<Curve>,
    /// Bits per sample of the picture, 8 or 16.
    pub bits: u32,
    /// The picture.
    pub out: PathBuf,
}

/// How a picture is computed.
#[derive(Debug, Clone)]
pub enum Engine {
    /// By a network in floating point, at a stride.
    Float(Stride),
    /// By a network in the board's integers.
    Fixed(FixedOptions),
    /// By demosaicing, without a network.
    Demosaic(Demosaicing),
}

/// What the board's integers are computed for.
#[derive(Debug, Clone, Default)]
pub struct FixedOptions {
    /// Stride that the network must have been quantized for.
    pub stride: Option<Stride>,
    /// Encoding of the board's codes.
    pub display: DisplayMode,
    /// File of the codes of the HDMI port; the picture is then what a screen shows of them.
    pub codes: Option<PathBuf>,
    /// Folder for the words at every stage boundary ([`words_file`]).
    pub words: Option<PathBuf>,
}

/// A picture that has been written.
#[derive(Debug, Clone)]
pub struct Reconstructed {
    /// The network and how it was computed, or the demosaicing.
    pub method: String,
    /// Rows and columns of the picture.
    pub size: (usize, usize),
    /// Tone of the picture.
    pub tone: Tone,
    /// Seconds of the network or the demosaicing.
    pub seconds: f64,
    /// Multiplications, where they are counted.
    pub multiplications: Option<Multiplications>,
    /// Counters of integers, and what the display clamped.
    pub counts: Option<(Counts, DisplayCounts)>,
    /// What was read.
    pub inputs: Vec<Input>,
}

/// Returns what was computed, and in how many seconds.
fn timed<T, E>(compute: impl FnOnce() -> Result<T, E>) -> Result<(T, f64), E> {
    let start = Instant::now();
    compute().map(|made| (made, start.elapsed().as_secs_f64()))
}

impl ReconstructJob {
    /// Reads the raw frames alone; returns them as inputs of results. For anybody with many scenes, before the first is computed.
    ///
    /// # Errors
    /// A frame that cannot be used.
    pub fn check(&self, note: &dyn Fn(FrameNote)) -> Result<Vec<Input>, JobError> {
        Ok(self.open(note)?.into_iter().map(|taken| taken.input).collect())
    }

    /// Reads the raw frames, computes the picture and writes the files.
    ///
    /// # Errors
    /// A frame or a network that cannot be used or do not fit each other, a file that cannot be written.
    pub fn run(&self, note: &dyn Fn(FrameNote)) -> Result<Reconstructed, JobError> {
        let exposures = self.open(note)?;
        exposures.iter().for_each(|taken| taken.remark(note));
        match &self.engine {
            Engine::Float(stride) => self.float(exposures, *stride, note),
            Engine::Fixed(options) => self.fixed(exposures, options, note),
            Engine::Demosaic(method) => self.by(&*method.reconstructor(), exposures, None, note),
        }
    }

    /// Returns the network's name or file: the one asked for, else the one for this lens, this tone, and the noise that the frame's record states. A noise that
    /// the user states chooses among the classes of the one asked for, too. Of an unknown lens nobody said that it has a mask.
    fn network<'a>(&'a self, taken: &Taken) -> &'a str {
        let tone = self.tone(taken);
        let usual = |camera: &Camera| {
            if camera.is_clear() { weights::clear_for(tone) } else { weights::default_for(tone) }
        };
        let trained = |camera| weights::trained_on(camera, tone).unwrap_or_else(|| usual(camera));
        let usual = || taken.camera.as_ref().map_or_else(|| weights::clear_for(tone), trained);
        let is_chosen = self.network.is_none() || self.source.stated.gain.is_some();
        let name = self.network.as_deref().unwrap_or_else(usual);
        match self.noise(taken).filter(|_| is_chosen) {
            Some(noise) => weights::for_noise(name, tone, noise),
            None => name,
        }
    }

    /// Returns the noise that the frame's record or the user states.
    fn noise(&self, taken: &Taken) -> Option<Noise> {
        taken.record.as_ref().map(|record| record.noise).or(self.source.stated.noise())
    }

    /// Returns the stated tone, else that of the record, else the one that suits a sensor's light.
    fn tone(&self, taken: &Taken) -> Tone {
        self.source.stated.tone.or(taken.record.as_ref().map(|record| record.tone)).unwrap_or(Tone::Srgb)
    }

    fn curve(&self, tone: Tone) -> Curve {
        self.curve.unwrap_or(match tone {
            Tone::Linear => Curve::Linear,
            Tone::Srgb => Curve::Srgb,
        })
    }

    fn float(
        &self,
        exposures: Vec<Taken>,
        stride: Stride,
        note: &dyn Fn(FrameNote),
    ) -> Result<Reconstructed, JobError> {
        let taken = &exposures[0];
        let name = self.network(taken);
        let network = weights::float(name)?;
        let input = weights::float_input(name)?;
        self.check_suits(&network.origin, &exposures, note)?;
        let method: Box<dyn Reconstructor> = match self.device.open()? {
            None => Box::new(FloatReconstructor::new(network, stride, Overlap::Hann, Output::Rgb)?),
            Some(device) => Box::new(GpuFloat::new(device, network, stride, Overlap::Hann)?),
        };
        self.by(&*method, exposures, Some(input), note)
    }

    /// Writes the picture that a method makes of light; `network` is the file of its weights, if it has any.
    fn by(
        &self,
        method: &dyn Reconstructor,
        exposures: Vec<Taken>,
        network: Option<Input>,
        note: &dyn Fn(FrameNote),
    ) -> Result<Reconstructed, JobError> {
        let light: Vec<_> = exposures.iter().map(|taken| taken.in_values(Tone::Linear)).collect();
        let light: Vec<&RawFrame> = light.iter().map(AsRef::as_ref).collect();
        let result = method.reconstruct_exposures(&light).map_err(|e| self.failed(e))?;
        let taken = &exposures[0];
        Ok(Reconstructed {
            method: method.name().to_owned(),
            size: self.save(result.frame, taken, note)?,
            tone: self.tone(taken),
            seconds: result.seconds,
            multiplications: result.multiplications,
            counts: None,
            inputs: exposures.into_iter().map(|taken| taken.input).chain(network).collect(),
        })
    }

    fn fixed(
        &self,
        mut exposures: Vec<Taken>,
        options: &FixedOptions,
        note: &dyn Fn(FrameNote),
    ) -> Result<Reconstructed, JobError> {
        let (network, input) = self.fixed_network(&exposures, options.stride, note)?;
        let taken = exposures.swap_remove(0);
        let mut method = format!("{}.fixed", network.origin.name);
        let values = network.origin.values;
        let (golden, raw) = (Golden::new(network)?, taken.in_values(values));
        // To the board leads a cable.
        let raw = if options.codes.is_some() { Cow::Owned(cable::carried(&raw)) } else { raw };
        let (out, seconds) = match self.device.open()? {
            None => timed(|| golden.frame(&raw)).map_err(|e| self.failed(e))?,
            Some(device) => {
                method += ".gpu";
                let gpu = GpuGolden::new(device, golden.network().clone(), &method)?;
                timed(|| gpu.frame(&raw)).map_err(|e| self.failed(e))?
            }
        };
        let curve = self.curve(self.tone(&taken));
        let (picture, shown) = out.picture(&Display::of_values(values, options.display, curve));
        let size = if let Some(codes) = &options.codes {
            let left_out = taken.left_out();
            if !left_out.is_empty() {
                note(FrameNote::NotFinished { path: self.source.path.clone(), left_out });
            }
            photo::save(&self.out, &picture.shown_frame(), self.bits)?;
            atomic::write(codes, &picture.yuyv())?;
            taken.frame.size()
        } else {
            let mut light = out.colour();
            values.lighten(&mut light);
            self.save(light, &taken, note)?
        };
        if let Some(folder) = &options.words {
            save_words(folder, &golden.words(&raw).map_err(|e| self.failed(e))?, &out.frame, &picture)?;
        }
        Ok(Reconstructed {
            method,
            size,
            tone: self.tone(&taken),
            seconds,
            multiplications: Some(out.counts.multiplications(golden.network())),
            counts: Some((out.counts, shown)),
            inputs: vec![taken.input, input],
        })
    }

    fn fixed_network(
        &self,
        exposures: &[Taken],
        asked: Option<Stride>,
        note: &dyn Fn(FrameNote),
    ) -> Result<(FixedNetwork, Input), JobError> {
        let name = self.network(&exposures[0]);
        let network = weights::fixed(name)?;
        let input = weights::fixed_input(name)?;
        self.check_suits(&network.origin, exposures, note)?;
        match asked.filter(|stride| *stride != network.stride) {
            Some(asked) => {
                Err(JobError::OtherStride { network: name.to_owned(), asked, quantized: network.stride })
            }
            None => Ok((network, input)),
        }
    }

    /// Writes a picture of light; returns its rows and columns.
    fn save(
        &self,
        mut light: ColourFrame,
        taken: &Taken,
        note: &dyn Fn(FrameNote),
    ) -> Result<(usize, usize), JobError> {
        taken.finish.correct(&mut light);
        taken.rendering.apply(&mut light);
        let (tone, light) = (self.tone(taken), taken.finish.frame(light));
        let curve = self.curve(tone);
        let picture = curve.encoded(light);
        // In the paper's convention numbers of sRGB are taken for light, so that light is not what a screen takes for it.
        let stated = match (tone, curve) {
            (Tone::Srgb, Curve::Linear) => Some(Statement::Linear),
            (Tone::Srgb, Curve::Bt709) => Some(Statement::Bt709),
            (Tone::Linear, _) | (_, Curve::Srgb) => None,
        };
        if stated.is_some() && picture::format_of(&self.out).map_err(PhotoError::from)? == Format::Pnm {
            note(FrameNote::CurveNotStated { path: self.out.clone() });
        }
        photo::save_stated(&self.out, &picture, self.bits, stated)?;
        Ok(picture.size())
    }

    /// Names the raw frame's file in an error.
    fn failed(&self, error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> JobError {
        JobError::in_file(&self.source.path, error)
    }
}

/// Returns the file of words in a folder.
#[must_use]
pub fn words_file(folder: &Path) -> PathBuf {
    folder.join("words.npz")
}

/// Writes the words at every stage boundary; docs/contract.md states the layout in section 8.
fn save_words(
    folder: &Path,
    boundaries: &[Boundary],
    frame: &Frame422,
    codes: &Picture,
) -> Result<(), JobError> {
    let mut npz = Npz::new();
    for boundary in boundaries {
        npz.add(&boundary.name, &boundary.words)?;
    }
    for (name, plane) in ["luma", "cb", "cr"].into_iter().zip(frame.bits()) {
        npz.add(name, &plane)?;
    }
    npz.add("y_code", &codes.luma)?;
    npz.add("cb_code", &codes.chroma[0])?;
    npz.add("cr_code", &codes.chroma[1])?;
    npz.save(&words_file(folder))
}
