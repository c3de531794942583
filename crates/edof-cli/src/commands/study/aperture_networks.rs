//! `edof study aperture-networks`: why not close the aperture, with a network for each lens?

use super::aperture::sorted;
use super::nets;
use super::options::{Kernels, MayKeepRows, Outputs, Photographs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::limits::all_within;
use crate::said;
use crate::ui::Ui;
use edof_core::Stride;
use edof_core::camera::Camera;
use edof_optics::Statistics;
use edof_study::aperture::networks::{ApertureNetworks, Peer, Photographing, Plan, Row};
use edof_study::aperture::{self};
use edof_study::methods::nets::Net;
use std::path::{Path, PathBuf};

/// Mean light of a scene, full scale 1, and side of the raw window: those of edof study aperture.
const MEAN_LIGHT: f64 = 0.4;
const WINDOW: usize = 12;

/// The coded lens against its own clear lens at smaller apertures, in the same light, each with networks of its own
///
/// Same scene, exposure time and sensor. Each stop halves the light and the defocus. A network's camera states its lens, aperture and range of
/// depths: edof study aperture --cameras writes these cameras. Several networks of one camera are for different light; each frame meets
/// the one that was trained for its noise. Lights that no network of a lens was trained for are left out.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study aperture --stops 0,1 --psi-ranges 8 --cameras cameras
  edof train --form edof-t4w12 --camera cameras/coded-8.json --gain 1:10 --out nets/a.safetensors
  edof train --form edof-t4w12 --camera cameras/clear-1-8.json --gain 2:20 --out nets/b.safetensors
  edof study aperture-networks --networks nets --rows rows.jsonl --report networks.html")]
pub struct Args {
    /// Folder of weight files, trained for the coded lens and for its clear lens at apertures of --stops
    #[arg(long, value_name = "DIR")]
    networks: PathBuf,

    /// The coded lens: a preset or a camera file; the clear one is the same lens without its mask
    #[arg(long, default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    /// Stops by which the clear lens may be closed; a stop halves its area
    #[arg(long, value_delimiter = ',', default_values = ["0", "0.5", "1", "1.5", "2", "3"], value_name = "STOPS,…")]
    stops: Vec<f64>,

    /// Light levels: electrons of a white pixel behind the open aperture
    #[arg(long, value_delimiter = ',', default_values = ["10000", "3000", "1000", "300", "100"], value_name = "E,…")]
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
/// No networks, networks of other lenses, nothing found, a file that is broken, settings out of range, or Ctrl-C.
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
    tell::<ApertureNetworks>(&journal, &args.outputs, ui)
}

/// Weight files of a folder, in the order of their names, without those in fixed point.
pub(super) fn networks_in(folder: &Path) -> Result<Vec<String>, Error> {
    const EXPECTED: &str = "expected a folder with NAME.safetensors of edof train";
    let wrong = |why: String| Error::message(format!("--networks {}: {why}, {EXPECTED}", folder.display()));
    let entries = std::fs::read_dir(folder).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    let names = entries.flatten().map(|entry| entry.path().to_string_lossy().into_owned());
    let is_float = |name: &String| name.ends_with(".safetensors") && !name.ends_with(".fixed.safetensors");
    let mut names: Vec<String> = names.filter(is_float).collect();
    names.sort();
    if names.is_empty() {
        return Err(wrong("has no weight files".to_owned()));
    }
    Ok(names)
}

impl Args {
    fn plan(&self, names: &[String], ui: &Ui) -> Result<Plan, Error> {
        all_within("--stops", &self.stops, 0.0, 8.0)?;
        all_within("--electrons", &self.electrons, 1.0, 1e9)?;
        all_within("--read-noise", &[self.read_noise], 0.0, 1e6)?;
        let coded = Camera::resolve(&self.camera)?;
        ui.used(coded.input());
        let stops = sorted(&self.stops);
        let mut cameras: Vec<(Camera, Vec<Net>)> = vec![];
        for name in names {
            let (float, sha256) = nets::float(name, ui)?;
            let camera = float.origin.camera.clone();
            let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
            let net = Net::new(stem, float, &sha256, None, Stride::PATCH).0;
            match cameras.iter_mut().find(|(known, _)| *known == camera) {
                Some((_, nets)) => nets.push(net),
                None => cameras.push((camera, vec![net])),
            }
        }
        let peers = cameras.into_iter().map(|(_, nets)| Peer::new(&coded, &stops, nets));
        Ok(Plan {
            peers: peers.collect::<Result<_, _>>()?,
            estimator: aperture::Plan {
                coded,
                ranges: vec![],
                stops,
                electrons: sorted(&self.electrons),
                read_noise_e: self.read_noise,
                mean_light: MEAN_LIGHT,
                window: said::window(WINDOW)?,
                statistics: Statistics::natural(),
            },
            optics: self.kernels.settings(),
        })
    }
}
