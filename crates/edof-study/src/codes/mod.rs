//! A task in place of decibels: sheets of codes behind lenses, at depths and lights, and how many of them programs can read.
//!
//! Lenses of different apertures see the same scene for the same time: ψ and light are those of the widest lens. A lens with a share a
//! of its area has a times its ψ, and a times its electrons. Modules have the same size in pixels at every depth.

mod page;
mod reader;
mod symbology;

pub use page::Codes;
pub use reader::{Reader, ReaderError};
pub use symbology::{Card, Sheet, Symbology, UnknownSymbology};

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::method::Method;
use crate::methods::spec::Ready;
use crate::metrics::{luma, shown};
use crate::opening::Opening;
use crate::setup::Setup;
use crate::trial::{Trial, TrialError, sensor};
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{ColourFrame, Noise, Tone};
use edof_optics::psf::{Settings, channel_psfs};
use ndarray::Array2;
use serde::{Deserialize, Serialize};

/// How many codes of one kind, depth and light a program reads in what a method makes of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Short name of the method.
    pub method: String,
    /// The method.
    #[serde(flatten)]
    pub identity: Method,
    /// Name of the camera.
    pub camera: String,
    /// Kind of code.
    pub symbology: Symbology,
    /// Side of a module in pixels.
    pub module_px: f64,
    /// Depth, as ψ of the widest lens.
    pub psi: f64,
    /// Noise behind the widest lens.
    pub noise: Noise,
    /// The program that reads.
    pub reader: Reader,
    /// Codes that are read rightly.
    pub read: usize,
    /// Codes.
    pub of: usize,
    /// Place of camera and method among those of the command that measured it: tables keep it.
    pub place: usize,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Subject {
    camera: String,
    method: Method,
    symbology: Symbology,
    module_px: Ordered,
    psi: Ordered,
    noise: Vec<Ordered>,
    reader: Reader,
}

impl Line for Row {
    const STUDY: &'static str = "codes";
    const LAYOUT: u32 = 1;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        Subject {
            camera: self.camera.clone(),
            method: self.identity.clone(),
            symbology: self.symbology,
            module_px: Ordered(self.module_px),
            psi: Ordered(self.psi),
            noise: Ordered::of_noise(self.noise),
            reader: self.reader,
        }
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        Self { place: 0, ..self.clone() }
    }
}

/// What is measured.
pub struct Plan {
    /// Cameras and their methods, in the order of tables.
    pub setups: Vec<Setup>,
    /// Sheets of codes.
    pub sheets: Vec<Sheet>,
    /// Depths, as ψ of the widest lens.
    pub psi: Vec<f64>,
    /// Noise behind the widest lens.
    pub noise: Vec<Noise>,
    /// Programs that read.
    pub readers: Vec<Reader>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// A row to be measured, by places in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    setup: usize,
    psi: usize,
    sheet: usize,
    noise: usize,
    method: usize,
    reader: usize,
    place: usize,
}

/// A failed study.
#[derive(Debug, thiserror::Error)]
pub enum CodesError {
    /// A frame that cannot be taken or reconstructed.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// A program that cannot be run.
    #[error(transparent)]
    Reader(#[from] ReaderError),
}

/// The experiment.
pub struct Reading<'a> {
    plan: &'a Plan,
}

impl<'a> Reading<'a> {
    /// A plan's lenses, sheets and lights.
    #[must_use]
    pub const fn new(plan: &'a Plan) -> Self {
        Self { plan }
    }
}

impl Experiment for Reading<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = CodesError;

    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let plan = self.plan;
        let mut cells = vec![];
        let mut first = 0;
        for (setup, Setup { camera, methods, .. }) in plan.setups.iter().enumerate() {
            let camera_sha256 = sha256(camera.to_json().as_bytes());
            for cell in plan.cells_of(setup) {
                let (sheet, spec) = (&plan.sheets[cell.sheet], &methods[cell.method]);
                let (psi, noise) = plan.seen(&cell);
                let subject = Subject {
                    camera: camera.name.clone(),
                    method: spec.method(),
                    symbology: sheet.symbology,
                    module_px: Ordered(sheet.module_px),
                    psi: Ordered(plan.psi[cell.psi]),
                    noise: Ordered::of_noise(plan.noise[cell.noise]),
                    reader: plan.readers[cell.reader],
                };
                let sensor = sensor(&sheet.photo.name, psi, noise);
                let proof = Proof {
                    settings: Some(settings(&[&spec.settings(), &plan.optics, &sensor, &sheet.cards.len()])),
                    weights: spec.weights().map(str::to_owned),
                    photo: Input::photograph(&sheet.photo.name, &sheet.photo.frame).sha256,
                    camera: Some(camera_sha256.clone()),
                    ..Proof::default()
                };
                cells.push((Key { subject, proof }, Cell { place: first + cell.method, ..cell }));
            }
            first += methods.len();
        }
        cells
    }

    fn belongs_to(&self, a: &Cell, b: &Cell) -> bool {
        (a.setup, a.psi, a.sheet) == (b.setup, b.psi, b.sheet)
    }

    /// Rows of one sheet at one depth: one frame for each noise, one reconstruction for each method.
    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, CodesError> {
        let plan = self.plan;
        let first = cells[0].0;
        let (Setup { camera, methods, .. }, sheet) = (&plan.setups[first.setup], &plan.sheets[first.sheet]);
        let (psi, _) = plan.seen(&first);
        let trial = Trial::new(camera, &sheet.photo, psi, Tone::Linear);
        let psfs = channel_psfs(camera, psi, &plan.optics).map_err(TrialError::Psf)?;
        let mut ready = Ready::new(camera, methods, psi, plan.optics);
        let (mut rows, mut last) = (vec![], None);
        for (cell, proof) in cells {
            let (_, noise) = plan.seen(cell);
            let picture = match last.take().filter(|(of, _)| *of == (cell.noise, cell.method)) {
                Some((_, picture)) => picture,
                None => {
                    let raw = &trial.shots(&psfs, &[noise])?[0].1;
                    let method = ready.method(noise, cell.method).map_err(TrialError::Prepare)?.reconstructor;
                    let failed = |source| TrialError::Reconstruct { image: trial.image(), source };
                    codes_of_luma(&method.reconstruct(raw).map_err(failed)?.frame)
                }
            };
            let reader = plan.readers[cell.reader];
            rows.push(Row {
                method: methods[cell.method].method().to_string(),
                identity: methods[cell.method].method(),
                camera: camera.name.clone(),
                symbology: sheet.symbology,
                module_px: sheet.module_px,
                psi: plan.psi[cell.psi],
                noise: plan.noise[cell.noise],
                reader,
                read: reader.count(&picture, sheet.symbology, &sheet.cards)?,
                of: sheet.cards.len(),
                place: cell.place,
                proof: proof.clone(),
            });
            last = Some(((cell.noise, cell.method), picture));
        }
        Ok(rows)
    }

    fn describe(&self, cell: &Cell) -> String {
        let (camera, sheet) = (&self.plan.setups[cell.setup].camera.name, &self.plan.sheets[cell.sheet]);
        format!("{camera} at psi {}: {}", self.plan.psi[cell.psi], sheet.photo.name)
    }
}

impl Plan {
    /// Every cell of a setup whose code its reader reads.
    fn cells_of(&self, setup: usize) -> Vec<Cell> {
        let mut cells = vec![];
        for psi in 0..self.psi.len() {
            for sheet in 0..self.sheets.len() {
                for noise in 0..self.noise.len() {
                    for method in 0..self.setups[setup].methods.len() {
                        let can = |reader: &usize| self.readers[*reader].reads(self.sheets[sheet].symbology);
                        let readers = (0..self.readers.len()).filter(can);
                        cells.extend(readers.map(|reader| Cell {
                            setup,
                            psi,
                            sheet,
                            noise,
                            method,
                            reader,
                            place: 0,
                        }));
                    }
                }
            }
        }
        cells
    }

    /// Returns ψ and noise behind a cell's lens.
    fn seen(&self, cell: &Cell) -> (f64, Noise) {
        let cameras = self.setups.iter().map(|setup| &setup.camera);
        let opening = Opening::among(&self.setups[cell.setup].camera, cameras);
        (opening.psi(self.psi[cell.psi]), opening.noise(self.noise[cell.noise]))
    }
}

/// Returns the luma of a frame as it is looked at, in codes of 0 to 255.
pub(crate) fn codes_of_luma(frame: &ColourFrame) -> Array2<u8> {
    luma(&shown(frame, Tone::Srgb)).mapv(|v| (255.0 * v.clamp(0.0, 1.0)).round() as u8)
}

#[cfg(test)]
mod tests;
