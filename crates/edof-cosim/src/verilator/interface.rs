//! The C functions of a compiled model.

use super::build::{Options, build};
use super::model::{Model, Start};
use crate::{Error, Layout, Source};
use std::ffi::{CStr, c_char, c_int};
use std::sync::Arc;

/// An instance of the model, on the C++ side.
pub enum Instance {}

/// The functions of `shim.cpp`, by the names that they have there. Valid while `library` is loaded.
pub struct Interface {
    pub message: unsafe extern "C" fn() -> *const c_char,
    pub create: unsafe extern "C" fn(i32, i32, *const c_char) -> *mut Instance,
    pub destroy: unsafe extern "C" fn(*mut Instance),
    pub poke: unsafe extern "C" fn(*mut Instance, u32, *const u32),
    pub peek: unsafe extern "C" fn(*mut Instance, u32, *mut u32),
    pub apply: unsafe extern "C" fn(*mut Instance, *const u32),
    pub sample: unsafe extern "C" fn(*mut Instance, *mut u32),
    pub settle: unsafe extern "C" fn(*mut Instance) -> c_int,
    pub tick: unsafe extern "C" fn(*mut Instance) -> c_int,
    pub run: unsafe extern "C" fn(*mut Instance, usize, *const u32, *mut u32) -> c_int,
    pub cycle: unsafe extern "C" fn(*const Instance) -> u64,
    pub trace: unsafe extern "C" fn(*mut Instance, *const c_char, u64, u64) -> c_int,
    pub end_trace: unsafe extern "C" fn(*mut Instance),
    library: libloading::Library,
}

/// A compiled design, loaded.
#[derive(Clone)]
pub struct Library {
    pub(super) interface: Arc<Interface>,
    source: Arc<Source>,
    inputs: Layout,
    outputs: Layout,
}

impl std::fmt::Debug for Library {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Library({} {:?})", self.source.top, self.interface.library)
    }
}

impl Library {
    /// Compiles the design, unless that was done before, and loads it.
    ///
    /// # Errors
    /// A tool is missing or refuses the design, or a file cannot be written.
    pub fn build(source: &Source, options: &Options) -> Result<Self, Error> {
        let product = build(source, options)?;
        let refuse =
            |error: libloading::Error| Error::Load { path: product.path.clone(), problem: error.to_string() };
        // SAFETY: the library is the one that `build` made from our shim, and its initialisers are Verilator's.
        let library = unsafe { libloading::Library::new(&product.path) }.map_err(refuse)?;
        // SAFETY: `build` compiled these functions from shim.cpp, whose types are those of `Interface`.
        let interface = unsafe { Interface::of(library) }.map_err(refuse)?;
        let (inputs, outputs) = (Layout::inputs(source), Layout::outputs(source));
        Ok(Self { interface: Arc::new(interface), source: Arc::new(source.clone()), inputs, outputs })
    }

    /// A fresh instance: memories loaded, inputs 0, clocks low.
    ///
    /// # Errors
    /// A memory image is missing or broken.
    pub fn start(&self, start: &Start) -> Result<Model, Error> {
        Model::start(self.clone(), start)
    }

    /// What it was compiled from.
    #[must_use]
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Rows of its inputs.
    #[must_use]
    pub const fn inputs(&self) -> &Layout {
        &self.inputs
    }

    /// Rows of its outputs.
    #[must_use]
    pub const fn outputs(&self) -> &Layout {
        &self.outputs
    }

    /// Why the last call on this thread failed.
    pub(super) fn stopped(&self) -> Error {
        // SAFETY: it gives a C string that lives until the next call on this thread.
        let text = unsafe { CStr::from_ptr((self.interface.message)()) };
        Error::Stopped(text.to_string_lossy().into_owned())
    }
}

impl Interface {
    /// # Safety
    /// The library was compiled from `shim.cpp`.
    unsafe fn of(library: libloading::Library) -> Result<Self, libloading::Error> {
        macro_rules! symbol {
            ($name:literal) => {
                // SAFETY: the caller vouches for the library, so the symbol has the type of the field it goes to.
                unsafe { *library.get($name)? }
            };
        }
        Ok(Self {
            message: symbol!(b"edof_message\0"),
            create: symbol!(b"edof_create\0"),
            destroy: symbol!(b"edof_destroy\0"),
            poke: symbol!(b"edof_poke\0"),
            peek: symbol!(b"edof_peek\0"),
            apply: symbol!(b"edof_apply\0"),
            sample: symbol!(b"edof_sample\0"),
            settle: symbol!(b"edof_settle\0"),
            tick: symbol!(b"edof_tick\0"),
            run: symbol!(b"edof_run\0"),
            cycle: symbol!(b"edof_cycle\0"),
            trace: symbol!(b"edof_trace\0"),
            end_trace: symbol!(b"edof_end_trace\0"),
            library,
        })
    }
}
