//! `edof study aperture`: why not close the aperture?

use super::options::{MayKeepRows, Outputs, measured, tell};
use crate::commands::optics::statistics;
use crate::error::Error;
use crate::files::Files;
use crate::limits::all_within;
use crate::said;
use crate::ui::Ui;
use edof_core::camera::Camera;
use edof_optics::Statistics;
use edof_study::aperture::{Aperture, Comparing, Plan};
use std::path::PathBuf;

/// The coded lens against its own clear lens at smaller apertures, in the same light: who is better, by how much
///
/// Same scene, exposure time and sensor. Each stop halves the light and the defocus. Both lenses are judged by the closed-form linear estimator
/// of edof optics design and focused where they are best. Seconds, no training, no pictures. With --cameras it also writes every lens as a camera
/// file; edof study aperture-networks compares the networks that were trained for them.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study aperture --report aperture.html
  edof study aperture --camera mine.json --psi-ranges 6 --electrons 5000,500 --stops 0,1,2
  edof study aperture --stops 0,1 --cameras cameras")]
pub struct Args {
    /// The coded lens: a preset or a camera file; the clear one is the same lens without its mask
    #[arg(long, default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    /// Far ends of the ranges of depth, as ψ at the open aperture; each range begins at 0
    #[arg(long, value_delimiter = ',', default_values = ["4", "8", "12"], value_name = "PSI,…")]
    psi_ranges: Vec<f64>,

    /// Stops by which the clear lens is closed; a stop halves its area
    #[arg(long, value_delimiter = ',', default_values = ["0", "0.5", "1", "1.5", "2", "3"], value_name = "STOPS,…")]
    stops: Vec<f64>,

    /// Light levels: electrons of a white pixel behind the open aperture
    #[arg(long, value_delimiter = ',', default_values = ["10000", "3000", "1000", "300", "100"], value_name = "E,…")]
    electrons: Vec<f64>,

    /// Read noise of the sensor in electrons, standard deviation
    #[arg(long, default_value_t = 2.5, value_name = "E")]
    read_noise: f64,

    /// Mean light of the scene, at which photon noise is taken; 1 is white
    #[arg(long, default_value_t = 0.4, value_name = "LIGHT")]
    mean_light: f64,

    /// Side in pixels of the raw window that the estimator sees
    #[arg(long, default_value_t = 12, value_name = "PIXELS")]
    window: usize,

    /// Folder of photographs to take statistics from [default: a built-in model of natural pictures]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    /// Folder for every lens, aperture and range as a camera file with its best focus, for networks to be trained for
    #[arg(long, value_name = "DIR")]
    cameras: Option<PathBuf>,

    #[command(flatten)]
    rows: MayKeepRows,

    #[command(flatten)]
    outputs: Outputs,
}

/// # Errors
/// An unknown camera, a lens that the estimator cannot judge, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = Files::new(ui).reads(&args.camera);
    let files = args.images.iter().fold(files, Files::reads_pictures_of);
    let plan = args.plan(ui)?;
    let files = match &args.cameras {
        Some(folder) => files.writes_into(
            "--cameras",
            folder,
            plan.camera_names().iter().map(|name| format!("{name}.json")),
        ),
        None => files,
    };
    args.outputs.of(args.rows.of(files)).check()?;
    if let Some(folder) = &args.cameras {
        for camera in plan.cameras()? {
            let file = folder.join(format!("{}.json", camera.name));
            edof_core::storage::atomic::write(&file, camera.to_json().as_bytes())?;
        }
    }
    let journal = measured(&mut Comparing::new(&plan), args.rows.rows.as_ref(), &args.rows.part, ui)?;
    tell::<Aperture>(&journal, &args.outputs, ui)
}

impl Args {
    fn plan(&self, ui: &Ui) -> Result<Plan, Error> {
        all_within("--psi-ranges", &self.psi_ranges, 0.1, 100.0)?;
        all_within("--stops", &self.stops, 0.0, 8.0)?;
        all_within("--electrons", &self.electrons, 1.0, 1e9)?;
        all_within("--read-noise", &[self.read_noise], 0.0, 1e6)?;
        all_within("--mean-light", &[self.mean_light], 0.0, 1.0)?;
        let coded = Camera::resolve(&self.camera)?;
        if coded.is_clear() {
            return Err(Error::message(format!(
                "--camera {}: has no mask, expected a coded lens such as ring-outer",
                self.camera
            )));
        }
        ui.used(coded.input());
        Ok(Plan {
            coded,
            ranges: sorted(&self.psi_ranges),
            stops: sorted(&self.stops),
            electrons: sorted(&self.electrons),
            read_noise_e: self.read_noise,
            mean_light: self.mean_light,
            window: said::window(self.window)?,
            statistics: match &self.images {
                Some(folder) => statistics(folder, ui)?,
                None => Statistics::natural(),
            },
        })
    }
}

/// Ascending, each once.
pub(super) fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
