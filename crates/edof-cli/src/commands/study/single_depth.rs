//! `edof study single-depth`: speed against error.

use super::nets;
use super::options::{Externals, Kernels, Outputs, Photographs, Rows, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, Depth};
use crate::said;
use crate::ui::Ui;
use edof::job::Device;
use edof_core::{Noise, Tone};
use edof_study::made::machines;
use edof_study::methods::dictionary::Dictionary;
use edof_study::methods::spec::MethodSpec;
use edof_study::single_depth::{Plan, SingleDepth};
use edof_study::speed::Speed;
use edof_study::study_report::StudyReport;
use edof_study::trial::usual_noise;
use std::path::PathBuf;
use std::sync::Arc;

/// Speed against error on scenes of one depth: networks, OMP, FISTA, deconvolution and demosaicing on the same frames
///
/// Every method is prepared for the camera, depth and noise (kernels, dictionaries), then timed on each photograph. The time is the median of
/// three runs after a first one, or that of one run longer than half a second. Wall-clock and CPU time are reported. Rows are written
/// to --rows when measured. The same command resumes a stopped study; further methods, depths or photographs add rows.
/// The sensor has 16 bits; kernels hold 99.9 % of the energy (all of it with --exact).
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study single-depth --rows rows.jsonl --report speed.html
  edof study single-depth --rows rows.jsonl --nets paper-t4 --methods omp,blind --markdown speed.md
  edof study single-depth --rows rows.jsonl --latex speed.tex

Methods:
  malvar, directional         demosaicing alone
  wiener, richardson-lucy, hyper-laplacian
                              demosaicing and deconvolution with the PSF known
  blind                       demosaicing, then blind deconvolution (Krishnan, Tay, Fergus 2011)
  omp, fista                  sparse pursuit, with one dictionary for all psi from 1 to 8
  omp-known, fista-known      the same with psi known
  untrained                   the paper's network before training, T = 3 to 10: ISTA of all psi
  untrained-dc-removed        the same with each colour's mean taken out")]
pub struct Args {
    #[command(flatten)]
    rows: Rows,

    /// Camera of all networks, by name or file
    #[arg(long, default_value = "ring-2018", value_name = "CAMERA")]
    camera: String,

    /// Networks by name or weight file; in float, and in fixed point if there are weights for the stride
    #[arg(long, value_delimiter = ',', default_value = "paper-t4,edof-t4w12", value_name = "NET,…")]
    nets: Vec<String>,

    /// Also measure the networks on a device: gpu (the first OpenCL device) or gpu:N (see 'edof doctor')
    #[arg(long, default_value_t)]
    device: Device,

    /// Other methods, from the list above [default: all]
    #[arg(long, value_delimiter = ',', value_name = "METHOD,…")]
    methods: Vec<String>,

    /// Depths: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or distances as in 1.5m if the camera states nominal_m
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<Depth>,

    /// Encoding of the photographs: linear (the paper's convention: samples are linear light), or srgb
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    tone: Tone,

    /// Noise levels: none, the standard deviation of Gaussian noise in units of full scale, or sensor, the photon and read
    /// noise of edof capture's reference sensor [default: none,0.01; with --tone srgb none,sensor]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "NOISE,…")]
    noise: Vec<Noise>,

    /// Pixels from one patch to the next, for methods of patches: 2, 4 or 8
    #[arg(long, value_delimiter = ',', default_value = "8,4", value_name = "PIXELS,…")]
    stride: Vec<usize>,

    /// Sharp dictionary of omp and fista, as edof study dictionary writes it [default: the one inside the program]
    #[arg(long, value_name = "FILE")]
    dictionary: Option<PathBuf>,

    #[command(flatten)]
    photographs: Photographs,

    #[command(flatten)]
    externals: Externals,

    /// Also write the tables as one in LaTeX (package booktabs): PSNR with standard errors over photographs, and time
    #[arg(long, value_name = "FILE")]
    latex: Option<PathBuf>,

    #[command(flatten)]
    outputs: Outputs,

    /// Also write the diagrams of PSNR against time as one SVG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = Files::new(ui).reads_all(&args.dictionary);
    let files = nets::read(files, &args.nets).reads_pictures_of(args.photographs.folder.path()?);
    let files = files.writes("--rows", &args.rows.rows).may_write("--plot", args.plot.as_ref());
    let files = files.may_write("--latex", args.latex.as_ref());
    args.outputs.of(files).check()?;
    // What is quick to reject comes before what takes its time.
    args.rows.check::<edof_study::single_depth::Row>()?;
    let externals = args.externals.methods()?;
    let (photos, skipped) = args.photographs.load(ui)?;
    let (plan, notes) = args.plan(externals, ui)?;
    notes.into_iter().chain(skipped).for_each(|note| ui.note(note));

    let mut experiment = SingleDepth::new(&plan, &photos);
    let journal = measured(&mut experiment, Some(&args.rows.rows), &args.rows.part, ui)?;
    let speed = || Speed::new(&journal.rows(), machines(&journal.makers()));
    if let Some(path) = &args.plot {
        edof_core::storage::atomic::write(path, speed()?.diagrams().as_bytes())?;
    }
    if let Some(path) = &args.latex {
        let made = ui.made(journal.makers(), journal.file());
        edof_core::storage::atomic::write(path, speed()?.to_latex(&made).as_bytes())?;
    }
    tell::<Speed>(&journal, &args.outputs, ui)
}

impl Args {
    /// What is to be measured, and what was left out, one line each.
    fn plan(&self, externals: Vec<MethodSpec>, ui: &Ui) -> Result<(Plan, Vec<String>), Error> {
        let camera = lens::resolve(&self.camera, None)?.camera;
        ui.used(camera.input());
        let strides = self.stride.iter().map(|&step| said::stride(step)).collect::<Result<Vec<_>, _>>()?;
        let dictionary = Arc::new(Dictionary::load(self.dictionary.as_deref())?);
        let mut others = vec![];
        for name in self.named() {
            others.extend(MethodSpec::named(name, &strides, &dictionary)?);
        }
        let (mut methods, mut notes) = (vec![], vec![]);
        for net in &self.nets {
            let (own, note) = nets::methods(net, &camera, &strides, ui)?;
            methods.extend(own);
            notes.extend(note);
        }
        notes.extend(nets::of_other_tone(&self.nets, self.tone)?);
        let (on_device, note) = nets::on_device(self.device, &methods)?;
        methods.extend(on_device);
        notes.extend(note);
        methods.extend(others);
        methods.extend(externals);
        let noise =
            if self.noise.is_empty() { usual_noise(self.tone)[..2].to_vec() } else { self.noise.clone() };
        let (psi, optics) = (said::psis(&self.psi, &camera)?, self.kernels.settings());
        Ok((Plan { camera, tone: self.tone, psi, noise, methods, optics }, notes))
    }

    fn named(&self) -> Vec<&str> {
        if self.methods.is_empty() {
            MethodSpec::names().to_vec()
        } else {
            self.methods.iter().map(String::as_str).collect()
        }
    }
}
