//! `edof study multi-depth`: the paper's figure 7.

use super::nets;
use super::options::{Kernels, Outputs, machine, unless_interrupted};
use crate::commands::scene;
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use edof_optics::draw::{Builtin, draw, four_depths};
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_spec::provenance::Input;
use edof_spec::{Camera, Noise, Reconstructor, Stride, Tone};
use edof_study::demo::{DemoError, Lens};
use edof_study::dictionary::Dictionary;
use edof_study::multi_depth::{self, BEHIND, BLIND, CODED, DEMOSAICED, MIDDLE, OMP};
use edof_study::spec::{Case, MethodSpec};
use std::path::PathBuf;
use std::sync::Arc;

/// Scenes at four depths through the coded lens and two clear ones: the columns of the paper's figure 7, and fairer peers
///
/// The clear lens is focused at the end of the range, as in the paper, and mid-range, with a network of its own. Behind each stand
/// demosaicing and blind deconvolution, behind the coded one OMP and networks too: in float, and in fixed point where there are
/// weights for the stride. Depths of the scenes are those of the coded lens's range.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study multi-depth --report four-depths.html
  edof study multi-depth --tone srgb --noise sensor:gain=4 --scenes leaves --stride 4 --csv rows.csv")]
pub struct Args {
    /// Scenes: chart, leaves
    #[arg(long, value_delimiter = ',', default_value = "chart,leaves", value_name = "SCENE,…")]
    scenes: Vec<String>,

    /// Nets behind the coded lens, all of one camera
    #[arg(long, value_delimiter = ',', default_value = "paper-t4,edof-t4w12", value_name = "NET,…")]
    nets: Vec<String>,

    /// Net behind the clear lens focused mid-range
    #[arg(long, default_value = "edof-t4w12-clear", value_name = "NET")]
    clear_net: String,

    /// What is measured: linear, light, or srgb, the picture encoded as it is looked at; drawn scenes are light in either case
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
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// No weights, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui).reads_all(&args.dictionary), &args.nets);
    args.outputs.of(nets::read(files, std::slice::from_ref(&args.clear_net))).check()?;
    scene::fits(args.width, args.height)?;
    let behind = args.behind(ui)?;
    let scenes = args.scenes(&behind[2].camera)?;
    let sensor = Sensor { depth: 12, noise: args.noise, seed: args.seed, ..Sensor::default() };
    let lenses: Vec<Lens<'_>> = behind.iter().map(Behind::lens).collect();
    let steps = scenes.len() * lenses.iter().map(|lens| lens.methods.len()).sum::<usize>();
    let progress = ui.progress(steps as u64, "pictures");
    let mut done = 0;
    let tell = |next: &str| {
        progress.message(next);
        progress.set(done);
        done += 1;
        unless_interrupted()
    };
    let study = match multi_depth::run(&scenes, &sensor, &lenses, args.tone, machine(ui), tell) {
        Err(DemoError::Stopped) => return Err(Error::Interrupted),
        other => other?,
    };
    drop(progress);
    let command = ui.provenance().command;
    let report = || Ok(study.report(&ui.signed(&command))?);
    args.outputs.write(|| study.to_markdown(&command), report, &study.rows())?;
    ui.say(study.to_text())?;
    ui.json(&study)
}

/// A lens, and the methods behind it with what tables call them.
struct Behind {
    title: &'static str,
    about: &'static str,
    camera: Camera,
    methods: Vec<(String, Box<dyn Reconstructor>)>,
}

impl Behind {
    fn lens(&self) -> Lens<'_> {
        Lens {
            title: self.title.into(),
            about: self.about.into(),
            camera: self.camera.clone(),
            methods: self.methods.iter().map(|(name, method)| (name.clone(), method.as_ref())).collect(),
        }
    }
}

impl Args {
    /// The three lenses, the coded one last, and its best network last of all.
    fn behind(&self, ui: &Ui) -> Result<[Behind; 3], Error> {
        let stride = [Stride::new(self.stride)?];
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
        at_coded.extend(networks(&coded, &self.nets)?);
        Ok([
            self.prepared(BEHIND, "sharp at the end of the range, as in the paper.", end, plain()?, ui)?,
            self.prepared(MIDDLE, "the same lens, sharp half-way.", middle, at_middle, ui)?,
            self.prepared(CODED, "a ring makes colours focus at different depths.", coded, at_coded, ui)?,
        ])
    }

    fn prepared(
        &self,
        title: &'static str,
        about: &'static str,
        camera: Camera,
        methods: Vec<(String, MethodSpec)>,
        ui: &Ui,
    ) -> Result<Behind, Error> {
        ui.used(Input::camera(&camera));
        // Blind ones take no depth from their case, and there is no one depth here.
        let case = Case { camera: &camera, psi: 0.0, noise: self.noise, optics: self.kernels.settings() };
        let methods = methods
            .into_iter()
            .map(|(name, spec)| Ok((name, spec.prepare(&case)?)))
            .collect::<Result<Vec<_>, Error>>()?;
        Ok(Behind { title, about, camera, methods })
    }

    fn scenes(&self, camera: &Camera) -> Result<Vec<Scene>, Error> {
        let depths = four_depths(camera.psi_range);
        let drawn = |name: &String| -> Result<Scene, Error> {
            Ok(draw(name.parse::<Builtin>()?, self.height, self.width, &depths, self.seed)?)
        };
        self.scenes.iter().map(drawn).collect()
    }
}
