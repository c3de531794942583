//! `edof study lens-networks`: which mask a scene needs, and what knowing the depth and several exposures are worth, by networks.

use super::aperture::sorted;
use super::aperture_networks::networks_in;
use super::nets;
use super::options::{Kernels, MayKeepRows, Outputs, Photographs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::limits::all_within;
use crate::ui::Ui;
use edof_core::Stride;
use edof_core::camera::Camera;
use edof_study::lens_networks::{LensNetworks, Photographing, Plan, Row, peers};
use edof_study::methods::nets::Net;
use std::path::{Path, PathBuf};

/// Masks against the clear lens at its best stop, and the gain of knowing the depth, each lens with networks of its own
///
/// Same scene, light, exposure time and sensor. A network's camera states its mask, focus and aperture; each stop halves the light and the defocus. Networks
/// of a range of depths serve all of --psi. Networks that were trained at one depth (--psi 4:4 --depths 1) know it: if there are any, the page states what
/// that is worth. Networks of several exposures (--form edof-t4w12,e2 --focus 2,6 with twice the --gain) share the time of one: if there are any, the page
/// states what they are worth. Networks that differ in their --seed alone are averaged. Lights that no network of a lens was trained for are left out.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof train --form edof-t4w12 --camera clear-mid --gain 1:10 --out nets/clear.safetensors
  edof train --form edof-t4w12 --camera mask.json --gain 1:10 --out nets/mask.safetensors
  edof study lens-networks --networks nets --electrons 10000,1000
  edof train --camera clear-mid --gain 1:10 --psi 8:8 --depths 1 --out nets/8.safetensors
  edof study lens-networks --networks nets --psi 0,8 --rows rows.jsonl --report depth.html")]
pub struct Args {
    /// Folder of weight files, trained for lenses that are --camera with any mask, focus and smaller aperture
    #[arg(long, value_name = "DIR")]
    networks: PathBuf,

    /// The clear lens when open: a preset or a camera file
    #[arg(long, default_value = "clear-mid", value_name = "CAMERA")]
    camera: String,

    /// Depths: ψ of the open aperture
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,2,4,6,8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<f64>,

    /// Light levels: electrons of a white pixel behind the open aperture
    #[arg(long, value_delimiter = ',', default_values = ["10000", "2500", "1000"], value_name = "E,…")]
    electrons: Vec<f64>,

    /// Read noise of the sensor in electrons, standard deviation
    #[arg(long, default_value_t = 2.5, value_name = "E")]
    read_noise: f64,

    #[command(flatten)]
    photographs: Photographs,

    #[command(flatten)]
    rows: MayKeepRows,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// No networks, networks of other lenses or depths, nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let names = networks_in(&args.networks)?;
    let files = Files::new(ui).reads(&args.camera).reads_all(&names);
    let files = files.reads_pictures_of(args.photographs.folder.path()?);
    args.rows.of(args.outputs.of(files)).check()?;
    args.rows.check::<Row>()?;
    let plan = args.plan(&names, ui)?;
    let (photos, skipped) = args.photographs.load(ui)?;
    skipped.into_iter().for_each(|note| ui.note(note));
    let mut experiment = Photographing::new(&plan, &photos);
    let journal = measured(&mut experiment, args.rows.rows.as_ref(), &args.rows.part, ui)?;
    tell::<LensNetworks>(&journal, &args.outputs, ui)
}

impl Args {
    fn plan(&self, names: &[String], ui: &Ui) -> Result<Plan, Error> {
        all_within("--psi", &self.psi, -100.0, 100.0)?;
        all_within("--electrons", &self.electrons, 1.0, 1e9)?;
        all_within("--read-noise", &[self.read_noise], 0.0, 1e6)?;
        let clear = Camera::resolve(&self.camera)?;
        ui.used(clear.input());
        let net = |name: &String| -> Result<Net, Error> {
            let (float, sha256) = nets::of_exposures(name, ui)?;
            let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
            Ok(Net::new(stem, float, &sha256, None, Stride::PATCH).0)
        };
        let nets = names.iter().map(net).collect::<Result<Vec<_>, _>>()?;
        let optics = self.kernels.settings();
        Ok(Plan {
            peers: peers(&clear, &sorted(&self.psi), nets, &optics)?,
            electrons: sorted(&self.electrons),
            read_noise_e: self.read_noise,
            optics,
        })
    }
}
