//! The edof crates for Python: arrays are NumPy's, work runs without the GIL, errors are exceptions with one line.
//!
//! | what | module |
//! |---|---|
//! | arguments, checked | [`arguments`] |
//! | exceptions | [`error`] |
//! | work that Ctrl-C ends | [`job`] |
//! | results as dicts | [`json`] |
//! | cameras | [`camera`] |
//! | PSF, OTF, blur and its adjoint | [`optics`] |
//! | scenes and raw frames | [`scene`] |
//! | a raw frame as an argument | [`shot`] |
//! | networks, float and fixed | [`network`] |
//! | training | [`train`] |
//! | from raw frames to pictures | [`reconstruct`] |
//! | corrections of sensors | [`sensor`] |
//! | picture files and metrics | [`pictures`] |
//! | demosaicing, deconvolution, pursuits | [`restore`] |
//! | designs and their sources | [`design`] |
//! | the cycle model | [`cycles`] |
//! | boards, real and simulated | [`board`] |
//!
//! What a function takes and gives is stated in `edof/_edof.pyi`. No algorithm lives here. Without the feature there is nothing here.

#![cfg(feature = "extension")]

mod arguments;
mod board;
mod camera;
mod cycles;
mod design;
mod error;
mod job;
mod json;
mod network;
mod optics;
mod pictures;
mod reconstruct;
mod restore;
mod scene;
mod sensor;
mod shot;
mod train;

use pyo3::prelude::*;

#[pymodule]
fn _edof(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("EdofError", module.py().get_type::<error::EdofError>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<camera::PyCamera>()?;
    module.add_class::<scene::PyScene>()?;
    module.add_class::<scene::PyCapture>()?;
    module.add_class::<network::PyNetwork>()?;
    module.add_class::<network::PyFixedNetwork>()?;
    module.add_class::<reconstruct::PyBoardPicture>()?;
    module.add_class::<sensor::PySensor>()?;
    module.add_class::<design::PyDesign>()?;
    module.add_class::<board::PyBoard>()?;
    let functions = [
        wrap_pyfunction!(optics::psf, module)?,
        wrap_pyfunction!(optics::otf, module)?,
        wrap_pyfunction!(optics::mtf, module)?,
        wrap_pyfunction!(optics::sampled_otf, module)?,
        wrap_pyfunction!(optics::blurred, module)?,
        wrap_pyfunction!(optics::blur_adjoint, module)?,
        wrap_pyfunction!(optics::encode, module)?,
        wrap_pyfunction!(optics::decode, module)?,
        wrap_pyfunction!(scene::captured, module)?,
        wrap_pyfunction!(reconstruct::reconstruct, module)?,
        wrap_pyfunction!(reconstruct::board_picture, module)?,
        wrap_pyfunction!(reconstruct::words, module)?,
        wrap_pyfunction!(reconstruct::cable_pixels, module)?,
        wrap_pyfunction!(board::uartbone_read, module)?,
        wrap_pyfunction!(board::uartbone_write, module)?,
        wrap_pyfunction!(board::uartbone_words, module)?,
        wrap_pyfunction!(restore::demosaic, module)?,
        wrap_pyfunction!(restore::wiener, module)?,
        wrap_pyfunction!(restore::richardson_lucy, module)?,
        wrap_pyfunction!(restore::sharpened, module)?,
        wrap_pyfunction!(restore::blind_deconvolution, module)?,
        wrap_pyfunction!(restore::omp, module)?,
        wrap_pyfunction!(restore::lasso, module)?,
        wrap_pyfunction!(restore::learned, module)?,
        wrap_pyfunction!(cycles::stall_pattern, module)?,
        wrap_pyfunction!(train::train, module)?,
        wrap_pyfunction!(pictures::load_picture, module)?,
        wrap_pyfunction!(pictures::save_picture, module)?,
        wrap_pyfunction!(pictures::metrics, module)?,
        wrap_pyfunction!(pictures::quality, module)?,
        wrap_pyfunction!(pictures::psnr, module)?,
    ];
    functions.into_iter().try_for_each(|function| module.add_function(function))
}
