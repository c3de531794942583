//! `edof study single-depth`: speed against error.

use super::{fixed_if_any, fixed_name, shown_name};
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{interrupt, weights};
use edof_optics::psf::Settings;
use edof_spec::provenance::Input;
use edof_spec::{Camera, Noise, Stride};
use edof_study::dictionary::Dictionary;
use edof_study::kodak::KodakError;
use edof_study::photos::{self, Selection};
use edof_study::single_depth::{self, Header, Journal, Plan, Progress, StudyError};
use edof_study::spec::MethodSpec;
use edof_study::speed::Speed;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

/// Speed against error on scenes of one depth: networks, OMP, FISTA, deconvolution and demosaicing on the same frames
///
/// Every method is prepared for the camera, depth and noise (kernels, dictionaries), then timed on each photograph: the median of
/// three runs after a first one, or one run where that takes longer than half a second. Both times are reported. Rows are written
/// to --rows as they come; the same command goes on where it was stopped, and further methods, depths or photographs add rows.
/// Photographs' values are taken for light; the sensor has 16 bits; kernels hold 99.9 % of the energy (all of it with --exact).
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study single-depth --rows rows.jsonl --report speed.html
  edof study single-depth --rows rows.jsonl --nets paper-t4 --methods omp,blind --stride 8,2 --psi 4,8 --markdown speed.md
Methods:
  malvar, directional         demosaicing alone
  wiener, richardson-lucy, hyper-laplacian
                              demosaicing and deconvolution with the PSF known
  blind                       demosaicing and blind deconvolution of each colour (Krishnan, Tay, Fergus 2011)
  omp, fista                  sparse pursuit in the dictionary of psi 1 to 8
  omp-known, fista-known      the same with psi known")]
pub struct Args {
    /// File of rows, JSON lines; gone on with if it is there
    #[arg(long, value_name = "FILE")]
    rows: PathBuf,

    /// Camera by name or file: the one that all nets were trained for
    #[arg(long, default_value = "ring-2018", value_name = "CAMERA")]
    camera: String,

    /// Nets by name or weight file; in float, and in fixed point where there are weights for the stride
    #[arg(long, value_delimiter = ',', default_value = "paper-t4,edof-t4w12", value_name = "NET,…")]
    nets: Vec<String>,

    /// Other methods; see below [default: all]
    #[arg(long, value_delimiter = ',', value_name = "METHOD,…")]
    methods: Vec<String>,

    /// Depths: the defocus parameter in radians
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<f64>,

    /// Noise levels: none, or the standard deviation of Gaussian noise in units of full scale
    #[arg(long, value_delimiter = ',', default_value = "none,0.01", value_name = "NOISE,…")]
    noise: Vec<Noise>,

    /// Pixels from one patch to the next, for methods of patches: 2, 4 or 8
    #[arg(long, value_delimiter = ',', default_value = "8,4", value_name = "PIXELS,…")]
    stride: Vec<usize>,

    /// Sharp dictionary of omp and fista, as edof study dictionary writes it [default: the one inside the program]
    #[arg(long, value_name = "FILE")]
    dictionary: Option<PathBuf>,

    /// Folder of numbered photographs [default: $EDOF_KODAK, else shared/data/kodak beside the project]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    /// test (every third number), train (the others), all, or numbers such as 3,6
    #[arg(long, default_value = "test")]
    photos: String,

    /// Also write the tables as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,

    /// Also write an HTML report with diagrams
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Whole kernels: no cut by energy
    #[arg(long)]
    exact: bool,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let folder = args.images.clone().map_or_else(photos::default_folder, Ok)?;
    let float = args.nets.iter().filter_map(|net| weights::float_file(net));
    let fixed = args.nets.iter().filter_map(|net| weights::fixed_file(&fixed_name(net)));
    let files = Files::new(ui)
        .reads_all(float)
        .reads_all(fixed)
        .reads_all(&args.dictionary)
        .reads_pictures_of(&folder);
    let files = files.writes("--rows", &args.rows).may_write("--report", args.report.as_ref());
    files.may_write("--markdown", args.markdown.as_ref()).check()?;
    let (plan, notes) = args.plan(ui)?;
    let selection: Selection = args.photos.parse()?;
    let (photos, skipped) = photos::load(&folder, &selection)?;
    photos.iter().for_each(|photo| ui.used(Input::photograph(&photo.name, &photo.frame)));
    let skipped = skipped.iter().map(|why| format!("photo skipped: {why}"));
    notes.into_iter().chain(skipped).for_each(|note| ui.note(note));

    let machine = machine(ui);
    let mut journal = Journal::open(&args.rows, Header::new(args.exact, machine.clone()))?;
    let steps = plan.psi.len() * plan.noise.len() * photos.len() * plan.methods.len();
    let progress = ui.progress(steps as u64, "rows");
    let tell = |p: Progress| {
        progress.message(p.last);
        progress.set(p.done as u64);
        if interrupt::check().is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    match single_depth::run(&plan, &photos, &mut journal, tell) {
        Err(StudyError::Trial(KodakError::Stopped)) => return Err(Error::Interrupted),
        other => other?,
    }
    let speed = Speed::new(journal.rows(), machine);
    let command = ui.provenance().command;
    if let Some(path) = &args.markdown {
        edof_spec::atomic::write(path, speed.to_markdown(&command).as_bytes())?;
    }
    if let Some(path) = &args.report {
        speed.report(&ui.signed(&command)).save(path)?;
    }
    ui.say(speed.to_text())?;
    ui.json(&speed)
}

/// CPU and threads, which every time is of.
fn machine(ui: &Ui) -> String {
    let host = ui.provenance().host;
    format!(
        "{}, {} threads",
        host.cpu,
        host.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
    )
}

impl Args {
    /// What is to be measured, and what was left out, one line each.
    fn plan(&self, ui: &Ui) -> Result<(Plan, Vec<String>), Error> {
        let camera = Camera::resolve(&self.camera)?;
        ui.used(Input::camera(&camera));
        let strides = self.stride.iter().map(|&step| Stride::new(step)).collect::<Result<Vec<_>, _>>()?;
        let dictionary = Arc::new(Dictionary::load(self.dictionary.as_deref())?);
        let (mut methods, mut notes) = (vec![], vec![]);
        for net in &self.nets {
            let (own, note) = network(net, &camera, &strides, ui)?;
            methods.extend(own);
            notes.extend(note);
        }
        let named: Vec<&str> = if self.methods.is_empty() {
            MethodSpec::names().to_vec()
        } else {
            self.methods.iter().map(String::as_str).collect()
        };
        for name in named {
            methods.extend(MethodSpec::named(name, &strides, &dictionary)?);
        }
        let optics = if self.exact { Settings::exact() } else { Settings::default() };
        Ok((Plan { camera, psi: self.psi.clone(), noise: self.noise.clone(), methods, optics }, notes))
    }
}

/// A net at every stride in float, and in fixed point where its weights are for one of them; a line that says so where they are not.
fn network(
    name: &str,
    camera: &Camera,
    strides: &[Stride],
    ui: &Ui,
) -> Result<(Vec<MethodSpec>, Option<String>), Error> {
    let mut float = weights::float(name)?;
    if float.origin.camera != *camera {
        let own = &float.origin.camera.name;
        return Err(Error::message(format!(
            "net '{name}': was trained for camera {own}, not {}: all methods stand behind one camera",
            camera.name
        )));
    }
    let shown = shown_name(name);
    float.origin.name = shown.to_owned();
    let input = weights::float_input(name)?;
    let sha256 = input.sha256.clone();
    ui.used(input);
    let float = Arc::new(float);
    let mut methods: Vec<MethodSpec> = strides
        .iter()
        .map(|&stride| MethodSpec::Float { network: Arc::clone(&float), sha256: sha256.clone(), stride })
        .collect();
    let Some(fixed) = fixed_if_any(&fixed_name(name))? else { return Ok((methods, None)) };
    if !strides.contains(&fixed.stride) || fixed.float_hash != sha256 {
        let why = "its fixed-point weights are for another stride or other float weights";
        return Ok((methods, Some(format!("NO {shown}.fixed ROWS: {why}"))));
    }
    let input = weights::fixed_input(&fixed_name(name))?;
    let sha256 = input.sha256.clone();
    ui.used(input);
    methods.push(MethodSpec::Fixed { network: Arc::new(fixed), name: shown.to_owned(), sha256 });
    Ok((methods, None))
}
