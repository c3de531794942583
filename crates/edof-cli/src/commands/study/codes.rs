//! `edof study codes`: over which depths can codes be read?

use super::nets;
use super::options::{Kernels, MayKeepRows, Outputs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::limits::all_within;
use crate::said;
use crate::ui::Ui;
use edof_core::Noise;
use edof_core::camera::Camera;
use edof_study::codes::{Codes, Plan, Reader, Reading, Sheet, Symbology};
use edof_study::methods::spec::MethodSpec;
use edof_study::setup::{Setup, setups};

/// Codes that can be read: QR, Data Matrix, EAN-13 and Code 128 behind each lens, at each depth and light, by programs that are not ours
///
/// Each network stands behind its own lens, with demosaicing beside it. Lenses see the same scene for the same time: ψ and noise are those of
/// the widest of them, and a smaller aperture gets less defocus and less light. The figure of merit is the range of depths at each of which
/// 95 % or more of the codes are read.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study codes --nets edof-t4w12-clear-light,edof-t4w12-outer-light --report codes.html
  edof study codes --nets edof-t4w12-light --lenses closed.json --codes qr --module-px 2 --zbarimg")]
pub struct Args {
    #[command(flatten)]
    rows: MayKeepRows,

    /// Networks by name or weight file, each with the camera that it was trained for; LOW+MID+HIGH is one method, as in edof study kodak
    #[arg(long, value_delimiter = ',', required = true, value_name = "NET,…")]
    nets: Vec<String>,

    /// Further lenses with demosaicing alone: presets or camera files
    #[arg(long, value_delimiter = ',', value_name = "CAMERA,…")]
    lenses: Vec<String>,

    /// Kinds of codes: qr, data-matrix, ean-13, code-128
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "qr,data-matrix,ean-13,code-128",
        value_name = "CODE,…"
    )]
    codes: Vec<Symbology>,

    /// Sides of a module in pixels; narrow bars are one module wide
    #[arg(long, value_delimiter = ',', default_values = ["2", "3"], value_name = "PIXELS,…")]
    module_px: Vec<f64>,

    /// Depths: ψ of the widest lens, the defocus in radians
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,1,2,3,4,5,6,7,8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<f64>,

    /// Noise levels behind the widest lens, as in edof capture
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "sensor,sensor:gain=10",
        allow_hyphen_values = true,
        value_name = "NOISE,…"
    )]
    noise: Vec<Noise>,

    /// Codes of each kind and size
    #[arg(long, default_value_t = 40, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    count: u64,

    /// Seed of texts and places
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,

    /// Also read by zbarimg, a program of Debian's package zbar-tools
    #[arg(long)]
    zbarimg: bool,

    /// Pixels from one patch to the next: 2, 4 or 8
    #[arg(long, default_value_t = 8, value_name = "PIXELS")]
    stride: usize,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, a reader that is missing, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui), &args.nets).reads_all(&args.lenses);
    args.rows.of(args.outputs.of(files)).check()?;
    args.rows.check::<edof_study::codes::Row>()?;
    let plan = args.plan(ui)?;
    let journal = measured(&mut Reading::new(&plan), args.rows.rows.as_ref(), &args.rows.part, ui)?;
    tell::<Codes>(&journal, &args.outputs, ui)
}

impl Args {
    fn plan(&self, ui: &Ui) -> Result<Plan, Error> {
        all_within("--module-px", &self.module_px, 1.0, 16.0)?;
        all_within("--psi", &self.psi, -100.0, 100.0)?;
        for &module_px in &self.module_px {
            let (width, height) = Sheet::max_size(module_px, self.count as usize);
            let given = format!("--count {} --module-px {module_px}", self.count);
            edof::job::check_memory(width, height).map_err(|e| Error::message(format!("{given}: {e}")))?;
        }
        let sheet = |kind, module_px| {
            Sheet::new(kind, module_px, self.count as usize, self.seed)
                .map_err(|e| Error::message(format!("--codes {kind}: {e}")))
        };
        let kinds = self.codes.iter();
        let sheets =
            kinds.flat_map(|kind| self.module_px.iter().map(move |module_px| sheet(*kind, *module_px)));
        Ok(Plan {
            setups: self.setups(ui)?,
            sheets: sheets.collect::<Result<_, Error>>()?,
            psi: self.psi.clone(),
            noise: self.noise.clone(),
            readers: [Reader::Rxing].into_iter().chain(self.zbarimg.then_some(Reader::Zbarimg)).collect(),
            optics: self.kernels.settings(),
        })
    }

    /// The networks behind their lenses, then further lenses.
    fn setups(&self, ui: &Ui) -> Result<Vec<Setup>, Error> {
        let stride = said::stride(self.stride)?;
        let mut loaded = vec![];
        for name in &self.nets {
            let (net, notes) = nets::of_one_frame(name, stride, ui)?;
            notes.iter().for_each(|note| ui.note(note));
            loaded.push(net);
        }
        let mut setups = setups(loaded)?;
        for name in &self.lenses {
            let camera = Camera::resolve(name)?;
            ui.used(camera.input());
            if !setups.iter().any(|setup| setup.camera == camera) {
                setups.push(Setup { camera, further_foci: vec![], methods: vec![MethodSpec::Malvar] });
            }
        }
        for (place, Setup { camera, .. }) in setups.iter().enumerate() {
            if setups[..place].iter().any(|other| other.camera.name == camera.name) {
                return Err(Error::message(format!(
                    "--nets, --lenses: two different cameras are called {}, which tables cannot distinguish; rename one",
                    camera.name
                )));
            }
        }
        Ok(setups)
    }
}
