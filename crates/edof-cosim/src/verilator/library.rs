//! A compiled design, loaded into this process.

use super::build::{Options, build};
use super::interface::Interface;
use crate::{Error, Layout, Source};
use std::ffi::CStr;
use std::sync::Arc;

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
    /// A tool is missing or rejects the design, or a file cannot be written.
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
