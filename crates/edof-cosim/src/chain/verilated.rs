//! The chain as Verilog, in Verilator.

use super::device::{Beat, Device, Inputs, Offer, Outputs, join, set, split};
use crate::error::{Error, at};
use crate::source::Source;
use crate::verilator::{Library, Model, Options, Start};
use crate::work;
use edof_core::storage::atomic::WorkFolder;
use edof_device::design::memory::Set;
use edof_hdl::project::Project;
use std::fs;
use std::path::Path;

/// A generated chain, compiled, with its memory images on disk.
#[derive(Debug)]
pub struct Compiled {
    library: Library,
    images: WorkFolder,
    stages: usize,
}

impl Compiled {
    /// Compiles a chain of `stages` stages.
    ///
    /// # Errors
    /// A tool is missing or rejects the text, or a file cannot be written.
    pub fn new(project: &Project, stages: usize, options: &Options) -> Result<Self, Error> {
        Self::of_source(&Source::from(project), project, stages, options)
    }

    /// Compiles what was made of a chain's files.
    ///
    /// # Errors
    /// As [`Compiled::new`].
    pub fn of_source(
        source: &Source,
        project: &Project,
        stages: usize,
        options: &Options,
    ) -> Result<Self, Error> {
        let library = Library::build(source, options)?;
        let images = work::folder()?;
        write_images(project, images.path())?;
        Ok(Self { library, images, stages })
    }

    /// A fresh chain; registers and memories without an image hold what `seed` draws.
    ///
    /// # Errors
    /// A memory image is broken, or the ports are not those of a chain.
    pub fn start(&self, seed: u64) -> Result<Verilated, Error> {
        let memory_dir = Some(self.images.path().to_path_buf());
        Verilated::new(self.library.start(&Start { seed, memory_dir })?, self.stages)
    }
}

/// Writes the memory images of a design where its `$readmemh` will look for them, below `dir`.
///
/// # Errors
/// A file cannot be written.
pub fn write_images(project: &Project, dir: &Path) -> Result<(), Error> {
    for (name, text) in &project.memory {
        let path = dir.join(name);
        path.parent().map_or(Ok(()), fs::create_dir_all).map_err(at(&path))?;
        fs::write(&path, text).map_err(at(&path))?;
    }
    Ok(())
}

/// A running model of a chain, its ports known by name.
pub struct Verilated {
    model: Model,
    ports: Ports,
}

struct Ports {
    reset: usize,
    flush: usize,
    window: Stream,
    window_ready: usize,
    patch: Stream,
    patch_ready: usize,
    write: [usize; 3],
    status_address: usize,
    status: usize,
    window_fault: usize,
    /// Streams between stages, and their receivers' `ready`.
    between: Vec<(Stream, usize)>,
}

struct Stream {
    valid: usize,
    data: usize,
    base: Option<usize>,
    last: usize,
    set: usize,
}

impl Stream {
    /// The ports of a stream: `name` and what its ports end in.
    fn find(source: &Source, port: impl Fn(&str) -> String) -> Result<Self, Error> {
        Ok(Self {
            valid: source.port(&port("valid"))?,
            data: source.port(&port("data"))?,
            base: source.port(&port("base")).ok(),
            last: source.port(&port("last"))?,
            set: source.port(&port("set"))?,
        })
    }
}

impl Verilated {
    /// A chain of `stages` stages.
    ///
    /// # Errors
    /// The model has not the ports of a chain.
    pub fn new(model: Model, stages: usize) -> Result<Self, Error> {
        let source = model.library().source();
        let between = |gap: usize| {
            let ready = source.port(&format!("between_ready_{gap}_o"))?;
            Ok((Stream::find(source, |p| format!("between_{p}_{gap}_o"))?, ready))
        };
        let ports = Ports {
            reset: source.port("reset_i")?,
            flush: source.port("flush_i")?,
            window: Stream::find(source, |p| format!("window_{p}_i"))?,
            window_ready: source.port("window_ready_o")?,
            patch: Stream::find(source, |p| format!("patch_{p}_o"))?,
            patch_ready: source.port("patch_ready_i")?,
            write: [
                source.port("write_valid_i")?,
                source.port("write_address_i")?,
                source.port("write_data_i")?,
            ],
            status_address: source.port("status_address_i")?,
            status: source.port("status_o")?,
            window_fault: source.port("window_fault_o")?,
            between: (0..stages - 1).map(between).collect::<Result<_, Error>>()?,
        };
        Ok(Self { model, ports })
    }

    /// The model below.
    pub const fn model(&mut self) -> &mut Model {
        &mut self.model
    }
}

/// The beat of a stream, if its `valid` is high.
fn beat(model: &mut Model, stream: &Stream) -> Result<Option<Beat>, Error> {
    if model.peek(stream.valid)? == 0 {
        return Ok(None);
    }
    let base = stream.base.map_or(Ok(0), |port| model.peek(port))?;
    Ok(Some(Beat {
        words: split(model.peek(stream.data)? as u32),
        base: split(base as u32),
        last: model.peek(stream.last)? != 0,
        set: set(model.peek(stream.set)? != 0),
    }))
}

impl Device for Verilated {
    fn cycle(&mut self, inputs: &Inputs, outputs: &mut Outputs) -> Result<(), Error> {
        let (model, ports) = (&mut self.model, &self.ports);
        model.poke(ports.reset, inputs.reset.into())?;
        model.poke(ports.flush, inputs.flush.into())?;
        model.poke(ports.window.valid, inputs.window.is_some().into())?;
        if let Some(beat) = inputs.window {
            model.poke(ports.window.data, join(beat.words).into())?;
            model.poke(ports.window.last, beat.last.into())?;
            model.poke(ports.window.set, (beat.set == Set::Second).into())?;
        }
        model.poke(ports.patch_ready, inputs.patch_ready.into())?;
        model.poke(ports.write[0], inputs.write.is_some().into())?;
        if let Some((address, data)) = inputs.write {
            model.poke(ports.write[1], address.into())?;
            model.poke(ports.write[2], data.into())?;
        }
        model.poke(ports.status_address, inputs.status_address.into())?;

        outputs.window_ready = model.peek(ports.window_ready)? != 0;
        outputs.status = model.peek(ports.status)? as u32;
        outputs.window_fault = model.peek(ports.window_fault)? != 0;
        outputs.between.clear();
        for (stream, ready) in &ports.between {
            let offer = Offer { beat: beat(model, stream)?, ready: model.peek(*ready)? != 0 };
            outputs.between.push(offer);
        }
        outputs.patch = beat(model, &ports.patch)?;
        model.tick()
    }
}
