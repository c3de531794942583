//! `edof study multi-depth`: the paper's figure 7.

use super::nets;
use super::options::{Externals, Kernels, MayKeepRows, Outputs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::said;
use crate::ui::Ui;
use edof_core::camera::Camera;
use edof_core::{Noise, Tone};
use edof_optics::draw::{Builtin, DrawError, four_depths};
use edof_study::methods::dictionary::Dictionary;
use edof_study::methods::spec::MethodSpec;
use edof_study::multi_depth::{
    BEHIND, BLIND, CODED, DEMOSAICED, Drawn, Lens, MIDDLE, MultiDepth, OMP, Plan, Scenes,
};
use std::path::PathBuf;
use std::sync::Arc;

/// Scenes at four depths through the coded lens and two clear ones: the columns of the paper's figure 7, and fairer peers
///
/// The clear lens is focused at the end of the range, as in the paper, and mid-range, with its own network. Each lens has
/// demosaicing and blind deconvolution. The coded lens also has OMP and networks, in float, and in fixed point if there are
/// weights for the stride. The depths of the scenes cover the coded lens's range.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study multi-depth --report four-depths.html
  edof study multi-depth --tone srgb --noise sensor:gain=4 --scenes leaves --csv rows.csv")]
pub struct Args {
    #[command(flatten)]
    rows: MayKeepRows,

    /// Scenes: chart, leaves
    #[arg(long, value_delimiter = ',', default_value = "chart,leaves", value_name = "SCENE,…")]
    scenes: Vec<String>,

    /// Networks of the coded lens, all for one camera
    #[arg(long, value_delimiter = ',', default_value = "paper-t4,edof-t4w12", value_name = "NET,…")]
    nets: Vec<String>,

    /// Network of the clear lens focused mid-range
    #[arg(long, default_value = "edof-t4w12-clear", value_name = "NET")]
    clear_net: String,

    /// What is measured: linear (light), or srgb (the encoded picture); synthetic scenes are linear light in either case
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    tone: Tone,

    /// Noise of the sensor as in edof capture
    #[arg(long, default_value_t = Noise::None, value_name = "NOISE")]
    noise: Noise,

    /// Pixels from one patch to the next, for methods of patches: 2, 4 or 8
    #[arg(long, default_value_t = 8, value_name = "PIXELS")]
    stride: usize,

    /// Rows of the scenes, even
    #[arg(long, default_value_t = 320, value_name = "PIXELS")]
    height: usize,

    /// Columns of the scenes, even
    #[arg(long, default_value_t = 480, value_name = "PIXELS")]
    width: usize,

    /// Seed of scenes and noise
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,

    /// Sharp dictionary of OMP, as edof study dictionary writes it [default: the one inside the program]
    #[arg(long, value_name = "FILE")]
    dictionary: Option<PathBuf>,

    #[command(flatten)]
    externals: Externals,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// No weights, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui).reads_all(&args.dictionary), &args.nets);
    let files = nets::read(files, std::slice::from_ref(&args.clear_net));
    args.rows.of(args.outputs.of(files)).check()?;
    args.rows.check::<edof_study::multi_depth::Row>()?;
    let sides = format!("--width {} --height {}", args.width, args.height);
    edof::job::check_memory(args.width, args.height).map_err(|e| Error::message(format!("{sides}: {e}")))?;
    let plan = args.plan(ui)?;
    let mut experiment = Scenes::new(&plan).map_err(|e| match e {
        DrawError::Size { .. } => Error::message(format!("{sides}: {e}")),
        e => e.into(),
    })?;
    let journal = measured(&mut experiment, args.rows.rows.as_ref(), &args.rows.part, ui)?;
    tell::<MultiDepth>(&journal, &args.outputs, ui)
}

impl Args {
    fn plan(&self, ui: &Ui) -> Result<Plan, Error> {
        let lenses = self.lenses(ui)?;
        let depths = lenses.last().map(|coded| four_depths(coded.camera.psi_range)).unwrap_or_default();
        Ok(Plan {
            scenes: self.scenes.iter().map(|scene| self.drawn(scene, &depths)).collect::<Result<_, _>>()?,
            depth: 12,
            noise: self.noise,
            tone: self.tone,
            lenses,
            optics: self.kernels.settings(),
        })
    }

    /// A scene at four depths.
    fn drawn(&self, scene: &str, depths: &[f64; 4]) -> Result<Drawn, Error> {
        scene.parse::<Builtin>()?;
        let (height, width, seed) = (self.height, self.width, self.seed);
        Ok(Drawn { scene: format!("{scene}-4"), height, width, psi: depths.to_vec(), seed })
    }

    /// The three lenses, the coded one last, and its best network last of all.
    fn lenses(&self, ui: &Ui) -> Result<Vec<Lens>, Error> {
        let stride = [said::stride(self.stride)?];
        let dictionary = Arc::new(Dictionary::load(self.dictionary.as_deref())?);
        let named = |name: &str| -> Result<MethodSpec, Error> {
            let mut methods = MethodSpec::named(name, &stride, &dictionary)?;
            Ok(methods.remove(0))
        };
        let plain = || -> Result<Vec<(String, MethodSpec)>, Error> {
            Ok(vec![(DEMOSAICED.into(), named("malvar")?), (BLIND.into(), named("blind")?)])
        };
        let end = Camera::resolve("clear")?;
        let middle = nets::camera(&self.clear_net)?;
        said::clear(&self.clear_net, &middle)?;
        let coded = self.nets.first().map(|net| nets::camera(net)).transpose()?;
        let coded = coded.ok_or_else(|| Error::message("--nets: names no network"))?;
        let networks = |camera: &Camera, nets: &[String]| -> Result<Vec<(String, MethodSpec)>, Error> {
            let mut all = vec![];
            for net in nets {
                let (methods, notes) = nets::methods(net, camera, &stride, ui)?;
                notes.iter().for_each(|note| ui.note(note));
                let pictures = methods.into_iter().filter(|m| !matches!(m, MethodSpec::Board { .. }));
                all.extend(pictures.map(|spec| (spec.method().to_string(), spec)));
            }
            Ok(all)
        };
        let mut at_middle = plain()?;
        at_middle.extend(networks(&middle, std::slice::from_ref(&self.clear_net))?);
        let mut at_coded = plain()?;
        at_coded.push((OMP.into(), named("omp")?));
        at_coded.extend(self.externals.methods()?.into_iter().map(|spec| (spec.method().to_string(), spec)));
        at_coded.extend(networks(&coded, &self.nets)?);
        let lens = |title, camera: Camera, methods| {
            ui.used(camera.input());
            Lens { title, camera, methods }
        };
        Ok(vec![lens(BEHIND, end, plain()?), lens(MIDDLE, middle, at_middle), lens(CODED, coded, at_coded)])
    }
}
