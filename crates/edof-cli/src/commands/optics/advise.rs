//! `edof optics advise`: the lens, stop and focus that a scene needs.

use super::scene::{Scene, with_range};
use crate::error::Error;
use crate::files::Files;
use crate::lens::DepthRange;
use crate::limits::all_within;
use crate::ui::Ui;
use edof_core::camera::Camera;
use edof_core::noise::SensorNoise;
use edof_core::words::number;
use edof_optics::bound::advise::{Advice, Choice, Kind, NETWORK_ERROR_DB, RANKING_ERROR_DB, advise};
use edof_optics::bound::lenses::Cubic;
use edof_optics::bound::{Light, Reached};
use edof_optics::{Statistics, distance_m};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Advise a lens for a range of depths and a light: mask or none, stop, focus, and what every other choice costs
///
/// Compares the clear lens, the camera's own mask and masks of the cubic family, each at its best stop and focus, by the best linear estimate
/// behind them, in equal light and time. States the dB to be expected of a trained network, and the most that any mask whatever could gain. A mask
/// is advised only where it is ahead by more than the comparison can err. Writes the lens as a camera file, and prints the command that trains a network
/// for it. Seconds, no training, no pictures.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof optics advise --range 0.4m:10m --aperture-mm 2 --electrons 3000
  edof optics advise --range 8:0 --electrons 1000 --read-noise 2.5
  edof optics advise ring-outer --electrons 2500 --task codes --module-px 2
  edof optics advise mine.json --electrons 300 --read-noise 10 --out advised.json --json")]
pub struct Args {
    #[command(flatten)]
    scene: Scene,

    /// Range of depths: distances as in 0.4m:10m, or ψ at the open aperture as in 8:0 [default: the camera's]
    #[arg(long, allow_hyphen_values = true, value_name = "NEAR:FAR")]
    range: Option<DepthRange>,

    /// Light: electrons of a white pixel behind the open aperture
    #[arg(long, default_value_t = 10_000.0, value_name = "E")]
    electrons: f64,

    /// What the pictures are for: photographs, or codes (black print on white, as QR codes and bar codes are)
    #[arg(long, value_enum, default_value_t = Task::Photographs, value_name = "TASK", conflicts_with = "images")]
    task: Task,

    /// Side of the modules of codes in pixels, for --task codes [default: 2]
    #[arg(long, value_name = "PIXELS")]
    module_px: Option<f64>,

    /// Camera file to write
    #[arg(long, value_name = "FILE", default_value = "out/advised.json")]
    out: PathBuf,
}

/// What pictures are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
enum Task {
    /// Natural pictures, judged by their dB.
    Photographs,
    /// Black print on white.
    Codes,
}

#[derive(Serialize)]
struct Advised<'a> {
    psi_range: [f64; 2],
    task: Task,
    #[serde(skip_serializing_if = "Option::is_none")]
    module_px: Option<f64>,
    advised: Shown,
    others: Vec<Shown>,
    expected_error_db: f64,
    cost_error_db: f64,
    limit_db: f64,
    any_mask_gains_at_most: Reached,
    camera: &'a Camera,
    train: String,
}

/// Usual side of the modules of codes in pixels: the smallest that programs read well.
const MODULE_PX: f64 = 2.0;

#[derive(Serialize)]
struct Shown {
    lens: Kind,
    stops: f64,
    f_number: f64,
    focus_psi: f64,
    focus_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<Reached>,
    cost: Reached,
}

/// # Errors
/// An unknown camera, numbers out of range, a range that is too wide at every stop, a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    args.scene.reads(Files::new(ui)).writes("--out", &args.out).check()?;
    let open = with_range(&args.scene.camera(ui)?, args.range)?;
    let light = args.scene.light(args.electrons)?;
    let module_px = args.module_px()?;
    let statistics = module_px.map_or_else(|| args.scene.statistics(ui), |px| Ok(Statistics::print(px)))?;
    let advice = advise(&open, light, &statistics)?;
    let camera = written(&advice, &open, &args)?;
    let train = train(&args.out, light, advice.advised.stops);
    for line in lines(&advice, &open, light, module_px) {
        ui.say(line)?;
    }
    ui.say(of_closed(&advice, light))?;
    ui.say(format!("The camera is in {}; a network for it:\n  {train}", args.out.display()))?;
    let shown = |choice: &Choice| shown(&advice, choice, &open, args.task);
    ui.json(&Advised {
        psi_range: open.psi_range,
        task: args.task,
        module_px,
        advised: shown(&advice.advised),
        others: advice.others.iter().map(shown).collect(),
        expected_error_db: NETWORK_ERROR_DB,
        cost_error_db: RANKING_ERROR_DB,
        limit_db: advice.ceiling.bayer_db,
        any_mask_gains_at_most: advice.any_mask_gains(),
        camera: &camera,
        train,
    })
}

impl Args {
    /// Side of the modules of codes, where codes are the task.
    fn module_px(&self) -> Result<Option<f64>, Error> {
        let given = self.module_px;
        if self.task == Task::Photographs {
            return given.map_or(Ok(None), |px| {
                Err(Error::message(format!(
                    "--module-px {}: is for --task codes; add that, or leave --module-px out",
                    number(px)
                )))
            });
        }
        all_within("--module-px", &given.into_iter().collect::<Vec<_>>(), 0.5, 32.0)?;
        Ok(Some(given.unwrap_or(MODULE_PX)))
    }
}

/// Writes the advised lens as a camera file.
fn written(advice: &Advice, open: &Camera, args: &Args) -> Result<Camera, Error> {
    let mut camera = advice.advised.camera.clone();
    camera.name = args.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    camera.source = format!(
        "edof optics advise: {} for psi {} to {} of the open aperture and {} electrons.",
        name(advice.advised.kind, open),
        number(open.psi_range[0]),
        number(open.psi_range[1]),
        number(args.electrons)
    );
    edof_core::storage::atomic::write(&args.out, camera.to_json().as_bytes())?;
    Ok(camera)
}

/// Returns the noise that captures of the advised lens have in this light: a smaller aperture leaves fewer electrons.
fn of_closed(advice: &Advice, light: Light) -> String {
    let gain = SensorNoise::default().full_well_e / light.electrons * advice.advised.stops.exp2();
    let gain = number((1e3 * gain.max(1.0)).round() / 1e3);
    let left = number((light.electrons / advice.advised.stops.exp2()).round());
    format!(
        "White has {left} electrons behind that aperture: capture it by --noise sensor:read-noise={}:gain={gain}; --gain {gain} of edof train, reconstruct and stream.",
        number(light.read_noise_e)
    )
}

/// The command that trains a network for a camera and a light.
pub fn train(camera: &Path, light: Light, stops: f64) -> String {
    let [low, high] = gains(light, stops).map(number);
    format!(
        "edof train --form edof-t4w12 --camera {} --tone srgb --gain {low}:{high} --out network.safetensors",
        camera.display()
    )
}

/// Gains that a network for a light is trained for: from half to twice that of the light, of those that a training takes, in thousandths.
pub fn gains(light: Light, stops: f64) -> [f64; 2] {
    let gain = SensorNoise::default().full_well_e / light.electrons * stops.exp2();
    [0.5, 2.0].map(|factor| (factor * gain * 1e3).round() / 1e3).map(|gain: f64| gain.clamp(1.0, 4096.0))
}

fn shown(advice: &Advice, choice: &Choice, open: &Camera, task: Task) -> Shown {
    Shown {
        lens: choice.kind,
        stops: choice.stops,
        f_number: choice.camera.f_number(),
        focus_psi: choice.focus_psi,
        focus_m: focus_m(choice, open),
        // The line to the dB of networks is of photographs.
        expected: (task == Task::Photographs).then(|| choice.expected()),
        cost: advice.cost(choice),
    }
}

fn focus_m(choice: &Choice, open: &Camera) -> Option<f64> {
    let metres = open.nominal_m.and_then(|nominal| distance_m(open, choice.focus_psi, nominal));
    metres.filter(|metres| metres.is_finite())
}

/// The advice in words.
pub fn lines(advice: &Advice, open: &Camera, light: Light, module_px: Option<f64>) -> Vec<String> {
    let Advice { advised, others, .. } = advice;
    let [low, high] = open.psi_range;
    let mut lines = vec![format!(
        "{}, F/{:.1} when open, psi {} to {}, {} electrons of a white pixel, read noise {}:",
        open.name,
        open.f_number(),
        number((10.0 * low).round() / 10.0),
        number((10.0 * high).round() / 10.0),
        number(light.electrons),
        number(light.read_noise_e)
    )];
    let mask = match advised.kind {
        Kind::Clear => "no mask".to_owned(),
        kind => format!("use {}", name(kind, open)),
    };
    let stop = if advised.stops > 0.0 {
        format!("close the lens by {}", stops(advised.stops))
    } else {
        "leave the lens open".to_owned()
    };
    let metres = focus_m(advised, open).map_or(String::new(), |m| format!(" at {m:.2} m,"));
    lines.push(format!(
        "Advice: {mask}; {stop} (F/{:.1}, an aperture of {:.2} mm); focus{metres} psi {:.1} of the open aperture.",
        advised.camera.f_number(),
        2.0 * advised.camera.aperture_radius_mm,
        advised.focus_psi
    ));
    lines.push(expected(advised, module_px));
    if advised.kind != Kind::Clear
        && let Some(clear) = others.iter().find(|other| other.kind == Kind::Clear)
    {
        let Reached { average_db, worst_db } = advice.cost(clear);
        let open_or = if clear.stops > 0.0 {
            format!("close it by {}", stops(clear.stops))
        } else {
            "leave it open".to_owned()
        };
        lines.push(format!(
            "Without a mask: {open_or} (F/{:.1}), focus psi {:.1}; it costs {average_db:.1} dB on average and {worst_db:.1} dB at the worst depth.",
            clear.camera.f_number(),
            clear.focus_psi
        ));
    }
    lines.push(format!(
        "Other choices cost (average / worst depth, +/- {RANKING_ERROR_DB} dB; below 0 they gain; the least cost of both together first; a mask must gain more than that):"
    ));
    for other in others {
        let Reached { average_db, worst_db } = advice.cost(other);
        let open_or =
            if other.stops > 0.0 { format!("closed by {}", stops(other.stops)) } else { "open".to_owned() };
        lines.push(format!(
            "  {average_db:+5.1} / {worst_db:+5.1} dB  {}, {open_or} (F/{:.1})",
            name(other.kind, open),
            other.camera.f_number()
        ));
    }
    let Reached { average_db, worst_db } = advice.any_mask_gains();
    lines.push(format!(
        "The limit: even if each pixel's depth were known, no mask whatever gains more than {average_db:.1} dB on average or {worst_db:.1} dB at the worst depth over the best clear lens."
    ));
    lines
}

/// What is to be expected of the advised lens.
fn expected(advised: &Choice, module_px: Option<f64>) -> String {
    let Reached { average_db, worst_db } = advised.expected();
    match module_px {
        None => format!(
            "A trained network is expected to reach {average_db:.1} dB on average over the depths and {worst_db:.1} dB at the worst, each +/- {NETWORK_ERROR_DB} dB."
        ),
        Some(px) => format!(
            "Ranked for black print on white with modules of {} pixels; how many codes are read behind a lens is counted by edof study codes.",
            number(px)
        ),
    }
}

fn name(kind: Kind, open: &Camera) -> String {
    match kind {
        Kind::Clear => "no mask".to_owned(),
        Kind::Own => format!("the mask of {}", open.name),
        Kind::Cubic(Cubic { strength, mixed }) => format!(
            "a cubic mask of {strength}(x^3 + y^3) + {mixed}(x^2 y + x y^2) rad at {} nm",
            number(open.reference_wavelength_nm)
        ),
    }
}

/// Stops in words.
pub fn stops(stops: f64) -> String {
    match stops {
        0.5 => "half a stop".to_owned(),
        1.0 => "one stop".to_owned(),
        stops => format!("{} stops", number(stops)),
    }
}
