//! `edof optics`, and `edof optics design`.

pub mod advise;
mod bound;
mod scene;
mod through;

use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::lens::{self, Depth, DepthRange, Lens};
use crate::psf_bank::{self, BankOptions};
use crate::said;
use crate::ui::Ui;
use edof::job::Npz;
use edof_core::Tone;
use edof_core::camera::{Camera, Term, centroid};
use edof_core::words::number;
use edof_optics::Statistics;
use edof_optics::bank;
use edof_optics::design::{self, Found, Search};
use edof_optics::distance_m;
use edof_optics::estimator::{Task, Verdict, judge};
use edof_optics::psf::{Psf, Settings};
use edof_optics::{green_cutoff_per_mm, sampled_otf};
use edof_study::lens::{
    AtDepth, contrast, contrast_plot, curve_depths, mtf_figure, mtf_plot, psf_sheet, without_mask,
};
use edof_study::report::picture::png;
use edof_study::report::plot::side_by_side;
use ndarray::{Array1, Array2, Array3, Array4, aview1};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Compute PSF, MTF and contrast over depth of a camera, or design a mask
///
/// Writes figure1.svg, the paper's Figure 1 (response to spatial frequency without the mask, contrast through focus with
/// and without it), and mtf.svg (response of red, green and blue without and with the mask; along rows and columns where they
/// differ). Also writes psf.png, the visible part of the point spread functions
/// (each channel scaled to its peak; first row with the mask, second without). Writes the same as numbers for NumPy: psf.npz (a PSF
/// bank, which --psf-bank reads) and mtf.npz (OTF and MTF; docs/your-own-lens.md lists the arrays).
///
/// ψ is the defocus in radians: ψ = (πR²/λ)(1/z − 1/z₀), with R the aperture's radius, z the distance and z₀ the distance of ψ = 0.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Args {
    #[command(subcommand)]
    task: Option<Subtask>,

    /// Camera: a preset (clear, clear-mid, clear-closed, ring-2015, ring-2018, ring-depth-2018, ring-outer) or a JSON file
    #[arg(default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    #[command(flatten)]
    bank: BankOptions,

    /// Folder for the figures
    #[arg(long, value_name = "DIR", default_value = "out/optics")]
    out: PathBuf,

    /// Depths: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or distances as in 1.5m if the camera states nominal_m [default: nine over the camera's range, or those of the PSF bank]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "PSI,…")]
    psi: Vec<Depth>,

    /// Distance of ψ = 0 in metres (inf for infinity); each depth is then also printed in metres [default: the camera's nominal_m]
    #[arg(long, value_name = "METRES")]
    nominal: Option<f64>,

    /// Share of the energy that a cut kernel keeps, more than 0 and at most 1
    #[arg(long, default_value_t = 0.999, value_name = "SHARE")]
    energy: f64,

    /// No approximation: whole kernels, all wavelengths
    #[arg(long)]
    exact: bool,
}

const EXAMPLES: &str = "\
Examples:
  edof optics ring-2018 --out out/optics
  edof optics ring-outer --psi 0,4,8 --nominal 10 --json
  edof optics ring-outer --psi 3m,5m,10m --nominal 10
  edof optics ring-outer --psf-bank measured.npz --out out/measured
  edof optics design --out mine.json
  edof optics design --rings 2 --psi-range -4,4 --noise 0.01 --images photos/train --out mine.json
  edof optics bound ring-outer --range 8:0,16:0
  edof optics advise --range 0.4m:10m --aperture-mm 2 --electrons 3000";

#[derive(clap::Subcommand)]
enum Subtask {
    Design(Design),
    Bound(bound::Args),
    Advise(advise::Args),
}

/// Search for the best mask and focus for a range of depths
///
/// The score of a candidate is computed in closed form: the error of the best linear map from a raw window to its colour patch, one map
/// for all depths. Differential evolution improves a random population without presets. The search takes minutes on two cores.
/// Check a camera by training a network for it: edof train --camera mine.json
///
/// --through NETWORK searches lens and network together. Each round trains the network for the lens, then moves radii, phases and focus along
/// the gradient of the PSNR through the network. The search begins with the mask and focus of --camera, or at random.
#[derive(clap::Args)]
#[command(after_help = DESIGN_EXAMPLES)]
struct Design {
    /// Camera file to write
    #[arg(long, value_name = "FILE", default_value = "out/camera.json")]
    out: PathBuf,

    /// Camera whose lens, sensor and range are taken: a preset or a JSON file
    #[arg(long, default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    /// Rings of the mask: 0, 1 or 2; with --through 3, too
    #[arg(long, default_value_t = 1, value_name = "N")]
    rings: usize,

    /// ψ of the plane of focus: the defocus in radians [default: searched within the range]
    #[arg(long, allow_hyphen_values = true, value_name = "PSI")]
    focus: Option<f64>,

    /// Range of ψ, the defocus in radians, or of distances as in 0.7m,3m if the camera states nominal_m [default: the camera's]
    #[arg(long, value_delimiter = ',', num_args = 1, allow_hyphen_values = true, value_name = "LOW,HIGH")]
    psi_range: Vec<Depth>,

    /// Standard deviations of the noise, in units of full scale; the scores are averaged
    #[arg(long, value_delimiter = ',', default_value = "0,0.01", value_name = "SIGMA,…")]
    noise: Vec<f64>,

    /// Weight of the worst depth against the average over depths, 0 to 1
    #[arg(long, default_value_t = 0.5, value_name = "SHARE")]
    worst_weight: f64,

    /// Side in pixels of the estimator's raw window: 8, 12 or 16
    #[arg(long, default_value_t = 12, value_name = "PIXELS")]
    window: usize,

    /// Largest absolute phase of a ring, in radians at the reference wavelength
    #[arg(long = "max-phase", alias = "most-phase", default_value_t = 10.0, value_name = "RADIANS")]
    max_phase: f64,

    /// Candidates per generation
    #[arg(long, default_value_t = 32, value_name = "N")]
    population: usize,

    /// Number of generations of the search
    #[arg(long, default_value_t = 64, value_name = "N")]
    generations: usize,

    /// Seed of the search
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,

    /// Folder of photographs whose statistics are used [default: a model of natural pictures; with --through the study's photographs]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    through: through::Options,
}

const DESIGN_EXAMPLES: &str = "\
Examples:
  edof optics design --out mine.json
  edof optics design --rings 2 --focus 0 --images photos/train --out mine.json
  edof optics design --through edof-t4w12-outer --out mine.json
  edof optics design --through edof-t4w12-outer --random --rings 2 --seed 3 --out mine.json
  edof optics design --generations 5 --population 12 --window 8 --json";

/// What is written.
const FILES: [&str; 5] = ["figure1.svg", "mtf.svg", "psf.png", "psf.npz", "mtf.npz"];
/// Frequencies from zero to green's cut-off at which mtf.npz holds the lens's response, and to half a cycle a pixel the sensor's.
const FREQUENCIES: usize = 129;

#[derive(Serialize)]
struct Shown {
    camera: String,
    depths: Vec<ShownDepth>,
    files: [String; FILES.len()],
}

#[derive(Serialize)]
struct ShownDepth {
    psi: f64,
    distance_m: Option<f64>,
    kernel_side: [usize; 3],
    energy_kept: [f64; 3],
    energy_beyond: [f64; 3],
    centroid: [[f64; 2]; 3],
    contrast_quarter_cutoff: [f64; 3],
}

/// # Errors
/// An unknown camera, depths out of reach, a folder or file that cannot be written, Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    match args.task {
        Some(Subtask::Design(args)) => return design(args, ui),
        Some(Subtask::Bound(args)) => return bound::run(args, ui),
        Some(Subtask::Advise(args)) => return advise::run(args, ui),
        None => {}
    }
    let Lens { camera, files } = lens::resolve(&args.camera, args.bank.file())?;
    Files::new(ui).reads_all(files).writes_into("--out", &args.out, FILES).check()?;
    ui.used(camera.input());
    let camera = args.before(camera)?;
    let (settings, psis) = (args.settings()?, args.depths(&camera)?);
    let files = FILES.map(|name| args.out.join(name));
    let clear = without_mask(&camera);
    let Computed { own, open, contrasts } = compute((&camera, &clear), &psis, &settings, ui)?;
    let figure1 = side_by_side(&[mtf_plot(&clear, &open), contrast_plot(&camera, &contrasts)?]);
    let mtf = mtf_figure((&camera, &own), (&clear, &open));
    let sheet = png(&psf_sheet(&[(&camera, &own), (&clear, &open)]), Tone::Linear)?;
    let depths: Vec<ShownDepth> = own.iter().map(|depth| shown(&camera, depth)).collect();
    edof_core::storage::atomic::write(&files[0], figure1.as_bytes())?;
    edof_core::storage::atomic::write(&files[1], mtf.as_bytes())?;
    edof_core::storage::atomic::write(&files[2], &sheet)?;
    psf_numbers(&camera, &own)?.save(&files[3])?;
    mtf_numbers(&camera, &own)?.save(&files[4])?;
    ui.say(format!(
        "{}: F/{:.2}, figures in {}; of red, green and blue, contrast at a quarter of green's cut-off, {:.0} cycles/mm:",
        camera.name,
        camera.f_number(),
        args.out.display(),
        0.25 * green_cutoff_per_mm(&camera)
    ))?;
    for d in &depths {
        let [r, g, b] = d.contrast_quarter_cutoff;
        let metres = d.distance_m.map_or(String::new(), |m| format!(", {m:.2} m"));
        ui.say(format!(
            "  psi {:5.2}{metres}: contrast {r:6.3} {g:6.3} {b:6.3}, kernels of {:?} pixels a side",
            d.psi, d.kernel_side
        ))?;
    }
    psf_bank::list(&camera, ui)?;
    ui.json(&Shown { camera: camera.name, depths, files: files.map(|file| file.display().to_string()) })
}

/// Everything that takes time.
struct Computed {
    /// The camera at each depth, and the same without its mask.
    own: Vec<AtDepth>,
    open: Vec<AtDepth>,
    /// Contrast at [`curve_depths`].
    contrasts: Vec<[f64; 3]>,
}

/// Depths of the contrast that are computed at once.
const AT_ONCE: usize = 4;

fn compute(
    (camera, clear): (&Camera, &Camera),
    psis: &[f64],
    settings: &Settings,
    ui: &Ui,
) -> Result<Computed, Error> {
    let curve = curve_depths(camera);
    let progress = ui.progress((psis.len() + curve.len()) as u64, "depths");
    progress.set(0);
    let (mut own, mut open, mut contrasts) = (vec![], vec![], vec![]);
    for psi in psis {
        interrupt::check()?;
        own.push(AtDepth::new(camera, *psi, settings)?);
        open.push(AtDepth::new(clear, *psi, settings)?);
        progress.set(own.len() as u64);
    }
    for some in curve.chunks(AT_ONCE) {
        interrupt::check()?;
        contrasts.extend(contrast(camera, some)?);
        progress.set((own.len() + contrasts.len()) as u64);
    }
    Ok(Computed { own, open, contrasts })
}

impl Args {
    /// The camera, with the distance that is ψ = 0 where one is given.
    fn before(&self, camera: Camera) -> Result<Camera, Error> {
        if let Some(metres) = self.nominal.filter(|m| m.is_nan() || *m <= 0.0) {
            return Err(Error::message(format!(
                "--nominal {}: must be a distance of more than 0 m",
                number(metres)
            )));
        }
        Ok(Camera { nominal_m: self.nominal.or(camera.nominal_m), ..camera })
    }

    /// The depths that are asked for, or else those that the camera's bank holds, or the usual ones.
    fn depths(&self, camera: &Camera) -> Result<Vec<f64>, Error> {
        let own = camera.psf_bank.as_ref().and_then(|bank| bank.kernels.as_ref());
        match own {
            Some(kernels) if self.psi.is_empty() => return Ok(kernels.psis().to_vec()),
            None if self.psi.is_empty() => return Ok(nine_depths(camera.psi_range)),
            _ => {}
        }
        said::psis(&self.psi, camera)
    }

    fn settings(&self) -> Result<Settings, Error> {
        let settings = Settings { energy: self.energy, exact: self.exact, ..Settings::default() };
        settings.check().map_err(|e| Error::message(format!("--{e}")))?;
        Ok(settings)
    }
}

/// Nine depths from one end of a range to the other.
fn nine_depths([low, high]: [f64; 2]) -> Vec<f64> {
    (0..=8).map(|i| low + (high - low) * f64::from(i) / 8.0).collect()
}

fn shown(camera: &Camera, AtDepth { psi, psfs, otfs }: &AtDepth) -> ShownDepth {
    let psi = *psi;
    ShownDepth {
        psi,
        distance_m: camera
            .nominal_m
            .and_then(|nominal| distance_m(camera, psi, nominal))
            .filter(|m| m.is_finite()),
        kernel_side: psfs.each_ref().map(Psf::side),
        energy_kept: psfs.each_ref().map(|p| p.energy_kept),
        energy_beyond: psfs.each_ref().map(|p| p.energy_beyond),
        centroid: psfs.each_ref().map(|p| centroid(p.kernel().view())),
        contrast_quarter_cutoff: otfs
            .each_ref()
            .map(|[along_row, _]| along_row.at(green_cutoff_per_mm(camera) / 4.0)),
    }
}

/// The kernels as a PSF bank (`edof_core::camera::PsfBank`).
fn psf_numbers(camera: &Camera, depths: &[AtDepth]) -> Result<Npz, Error> {
    let kernels = depths.iter().map(|depth| depth.psfs.each_ref().map(|psf| psf.kernel()));
    let kernels: Vec<[&Array2<f32>; 3]> = kernels.collect();
    let mut npz = Npz::new();
    npz.add("psi", &psis(depths))?;
    npz.add("psf", &bank::stacked(&kernels))?;
    npz.add("pixel_pitch_um", &aview1(&[camera.pixel_pitch_um]))?;
    Ok(npz)
}

/// What the figures draw, and the transform of what the pixels sample.
fn mtf_numbers(camera: &Camera, depths: &[AtDepth]) -> Result<Npz, Error> {
    let share = |index: usize| index as f64 / (FREQUENCIES - 1) as f64;
    let per_mm: Array1<f64> = (0..FREQUENCIES).map(|i| share(i) * green_cutoff_per_mm(camera)).collect();
    let per_pixel: Vec<f64> = (0..FREQUENCIES).map(|i| 0.5 * share(i)).collect();
    let mut lens = Array3::<f64>::zeros((depths.len(), 3, FREQUENCIES));
    let mut sensor = [(); 2].map(|()| Array4::<f64>::zeros((depths.len(), 3, 2, FREQUENCIES)));
    for (depth, AtDepth { psfs, otfs, .. }) in depths.iter().enumerate() {
        for (plane, (psf, [along_row, _])) in psfs.iter().zip(otfs).enumerate() {
            for (index, both) in sampled_otf(psf, &per_pixel).into_iter().enumerate() {
                lens[(depth, plane, index)] = along_row.at(per_mm[index]);
                for (axis, value) in both.into_iter().enumerate() {
                    sensor[0][(depth, plane, axis, index)] = value.re;
                    sensor[1][(depth, plane, axis, index)] = value.im;
                }
            }
        }
    }
    let [real, imaginary] = sensor;
    let mut npz = Npz::new();
    npz.add("psi", &psis(depths))?;
    npz.add("lens_cycles_per_mm", &per_mm)?;
    npz.add("lens_otf", &lens)?;
    npz.add("sensor_cycles_per_pixel", &Array1::from(per_pixel))?;
    npz.add("sensor_mtf", &ndarray::Zip::from(&real).and(&imaginary).map_collect(|re, im| re.hypot(*im)))?;
    npz.add("sensor_otf_real", &real)?;
    npz.add("sensor_otf_imaginary", &imaginary)?;
    Ok(npz)
}

fn psis(depths: &[AtDepth]) -> Array1<f64> {
    depths.iter().map(|depth| depth.psi).collect()
}

#[derive(Serialize)]
struct Designed {
    camera: Camera,
    psi: Vec<f64>,
    noise: Vec<f64>,
    judged: usize,
    seconds: f64,
    cameras: Vec<Judged>,
}

#[derive(Serialize)]
struct Judged {
    name: String,
    score_db: f64,
    psnr_db: Vec<Vec<f64>>,
}

fn design(args: Design, ui: &Ui) -> Result<(), Error> {
    if let Some(network) = &args.through.through {
        return through::design(&args, network, ui);
    }
    let files = Files::new(ui).reads(&args.camera);
    let files = args.images.iter().fold(files, Files::reads_pictures_of);
    files.writes("--out", &args.out).keeps(args.force).check()?;
    let base = args.base()?;
    ui.used(base.input());
    let statistics = args.statistics(ui)?;
    let task =
        Task { noises: args.noise.clone(), worst_weight: args.worst_weight, ..design::default_task(&base) };
    let task = Task { window: said::window(args.window)?, ..task };
    let (rings, focus, max_phase, seed) = (args.rings, args.focus, args.max_phase, args.seed);
    let search =
        Search { rings, focus, max_phase, population: args.population, generations: args.generations, seed };
    let start = std::time::Instant::now();
    let progress = ui.progress(args.generations as u64, "generations");
    let Found { mut camera, verdict, judged } =
        design::search(&base, &statistics, &task, &search, |done, db| {
            progress.message(format!("{db:.2} dB"));
            progress.set(done as u64);
            interrupt::flow()
        })
        .map_err(said::lens_design)?;
    drop(progress);
    interrupt::check()?;
    camera.name = args.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    camera.source = args.source(&verdict, judged);
    edof_core::storage::atomic::write(&args.out, camera.to_json().as_bytes())?;
    let seconds = start.elapsed().as_secs_f64();
    let mut cameras =
        vec![Judged { name: camera.name.clone(), score_db: verdict.score_db, psnr_db: verdict.psnr_db }];
    for name in ["ring-outer", "clear-mid", "ring-2018"] {
        let Verdict { psnr_db, score_db } = judge(&Camera::resolve(name)?, &statistics, &task)?;
        cameras.push(Judged { name: name.to_owned(), score_db, psnr_db });
    }
    ui.say(format!("{judged} cameras judged in {seconds:.0} s; the best is in {}", args.out.display()))?;
    cameras.iter().try_for_each(|judged| tell(judged, &task, ui))?;
    ui.json(&Designed { camera, psi: task.psis, noise: task.noises, judged, seconds, cameras })
}

fn tell(judged: &Judged, task: &Task, ui: &Ui) -> Result<(), Error> {
    ui.say(format!("  {:16} score {:.2} dB", judged.name, judged.score_db))?;
    for (noise, db) in task.noises.iter().zip(&judged.psnr_db) {
        let worst = db.iter().copied().fold(f64::INFINITY, f64::min);
        let average = db.iter().sum::<f64>() / db.len() as f64;
        ui.say(format!(
            "    noise {noise}: linear estimator, average {average:.2} dB, worst depth {worst:.2} dB"
        ))?;
    }
    Ok(())
}

/// Statistics of a folder's photographs.
///
/// # Errors
/// Nothing in it, or nothing large enough.
pub fn statistics(folder: &Path, ui: &Ui) -> Result<Statistics, Error> {
    let found = edof_io::photo::load_folder(folder)?;
    found.skipped.iter().for_each(|why| ui.note(format!("photo skipped: {why}")));
    found.remarks.into_iter().for_each(|line| ui.note(line));
    Statistics::of_photos(found.photographs.iter().map(|(_, photo)| photo))
        .map_err(|e| said::of_file(folder, e))
}

impl Design {
    /// The given lens and sensor, with the asked range.
    fn base(&self) -> Result<Camera, Error> {
        let mut base = Camera::resolve(&self.camera)?;
        // Another mask has other PSFs.
        base.psf_bank = None;
        let is_kept = |term: &Term| !matches!(term, Term::HeightMap(_));
        base.mask = base.mask.into_terms().into_iter().filter(is_kept).collect();
        base.psi_range = match self.psi_range[..] {
            [] => base.psi_range,
            [low @ Depth::Psi(_), high] | [low, high @ Depth::Psi(_)] => {
                let psi =
                    |depth: Depth| depth.psi(&base).map_err(|e| Error::message(format!("--psi-range {e}")));
                [psi(low)?, psi(high)?]
            }
            [near, far] => {
                DepthRange { near, far }.psi(&base).map_err(|e| Error::message(format!("--psi-range {e}")))?
            }
            _ => {
                return Err(Error::message(
                    "--psi-range: two values of psi as in 0,8, or two distances as in 0.7m,3m",
                ));
            }
        };
        let given = || self.psi_range.iter().map(|depth| depth.in_words()).collect::<Vec<_>>().join(",");
        let wrong = |e| Error::message(format!("--psi-range {}: {e}", given()));
        base.check().map_err(|e| if self.psi_range.is_empty() { e.into() } else { wrong(e) })?;
        Ok(base)
    }

    fn statistics(&self, ui: &Ui) -> Result<Statistics, Error> {
        let Some(folder) = &self.images else { return Ok(Statistics::natural()) };
        statistics(folder, ui)
    }

    fn source(&self, verdict: &Verdict, judged: usize) -> String {
        let noise = self.noise.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
        format!(
            "edof optics design --camera {} --rings {} --window {} --worst-weight {} --noise {} --seed {}: the best of {judged} \
             cameras by the linear estimator, score {:.2} dB",
            self.camera, self.rings, self.window, self.worst_weight, noise, self.seed, verdict.score_db
        )
    }
}
