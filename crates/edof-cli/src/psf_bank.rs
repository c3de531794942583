//! What a PSF bank does to a picture: by how far it moves each colour, and how much light its arrays seem to cut off.

use crate::error::Error;
use crate::lens::BankFile;
use crate::ui::Ui;
use edof_core::camera::{Camera, Kernels, centroid};
use std::path::PathBuf;

/// Options of a PSF bank.
#[derive(clap::Args)]
pub struct BankOptions {
    /// PSF bank in place of the camera's computed PSFs: an NPZ or safetensors file with the arrays psi and psf, or X-psf.npy, which has X-psi.npy
    /// beside it (docs/your-own-lens.md)
    #[arg(long, value_name = "FILE")]
    pub psf_bank: Option<PathBuf>,

    /// Shift the PSF bank by one displacement, so that the mean centroid of its kernels is pixel (rows/2, columns/2); parts of a pixel
    /// are interpolated
    #[arg(long, requires = "psf_bank")]
    pub centre: bool,
}

impl BankOptions {
    /// The bank that is asked for.
    pub fn file(&self) -> Option<BankFile<'_>> {
        self.psf_bank.as_deref().map(|path| BankFile { path, centre: self.centre })
    }
}

/// Share of a kernel's light on its array's edge from which on the array seems too small.
const MUCH: f64 = 0.005;

/// Prints the centroids of every depth and colour of a camera's PSF bank, if it has one, with what the arrays seem to cut off.
pub fn list(camera: &Camera, ui: &Ui) -> Result<(), Error> {
    let Some((file, kernels)) = of(camera) else { return Ok(()) };
    ui.say(format!(
        "PSF bank {file}: centroids from the middle pixel (rows/2, columns/2), and light on the edge of the array"
    ))?;
    for (depth, psi) in kernels.psis().iter().enumerate() {
        let colours = ["red", "green", "blue"].into_iter().zip(kernels.at(depth)).zip(kernels.edges(depth));
        let colours: Vec<String> = colours
            .map(|((name, kernel), edge)| {
                format!("{name} {}, {:.2} %", offset(centroid(kernel.view())), 100.0 * edge)
            })
            .collect();
        ui.say(format!("  psi {psi:5.2}: {}", colours.join("; ")))?;
    }
    remark(camera, ui);
    Ok(())
}

/// Notes a bank that moves the picture as a whole, and arrays that seem to be too small.
pub fn remark(camera: &Camera, ui: &Ui) {
    let Some((file, kernels)) = of(camera) else { return };
    let mean = kernels.mean_centroid();
    if mean.iter().any(|pixels| pixels.abs() > 0.5) {
        ui.note(format!(
            "PSF bank {file}: moves the picture by {} on average; --centre shifts the bank back",
            offset(mean)
        ));
    }
    let edges = (0..kernels.psis().len()).flat_map(|depth| kernels.edges(depth));
    let most = edges.fold(0.0, f64::max);
    if most > MUCH {
        ui.note(format!(
            "PSF bank {file}: up to {:.2} % of a kernel's light is on the edge of its array, so more may be cut off; take larger arrays",
            100.0 * most
        ));
    }
}

/// Pixels to the right and down, in words.
pub fn offset([right, down]: [f64; 2]) -> String {
    let word = |pixels: f64, after, before| {
        format!("{:.2} {}", pixels.abs(), if pixels < 0.0 { before } else { after })
    };
    format!("{}, {}", word(right, "right", "left"), word(down, "down", "up"))
}

fn of(camera: &Camera) -> Option<(&str, &Kernels)> {
    let bank = camera.psf_bank.as_ref()?;
    Some((&bank.file, bank.kernels.as_deref()?))
}
