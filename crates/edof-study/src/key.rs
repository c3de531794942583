//! Text that the keys of rows are hashes of: every setting by a name that is written here.
//!
//! Names of fields and variants in Rust may change, and keys stay. A new field of a setting is an error of the compiler in this file until
//! it has a place. Version 1 has the form that programs before it took from Rust, so that their rows keep their keys. A change of a
//! setting's text needs a new [`VERSION`]: rows of another version are measured anew.

use crate::methods::settings::{
    DeconvolutionSettings, Depths, FloatSettings, PictureModel, Pursuit, PursuitSettings, UntrainedSettings,
};
use edof_core::camera::Camera;
use edof_core::noise::SensorNoise;
use edof_core::overlap::Overlap;
use edof_core::words::number;
use edof_core::{CfaPhase, Noise, Stride, Tone, Window};
use edof_deblur::blind;
use edof_deblur::hyper_laplacian::Prior;
use edof_network::float::reconstruct::Output;
use edof_network::network::{Condition, Form, Recurrence, Shrinkage};
use edof_optics::Sensor;
use edof_optics::capture::Approximation;
use edof_optics::psf::Settings;
use serde::Serialize;
use serde_json::Value;

/// Version of the text.
pub const VERSION: u32 = 1;

/// A setting that keys of rows depend on.
pub trait KeyText {
    /// Returns the setting as text, numbers to the last bit.
    fn key_text(&self) -> String;
}

/// Returns the text of a setting that has fields.
pub fn record(name: &str, fields: &[(&str, &dyn KeyText)]) -> String {
    let each: Vec<String> =
        fields.iter().map(|(field, value)| format!("{field}: {}", value.key_text())).collect();
    format!("{name} {{ {} }}", each.join(", "))
}

/// Returns the word of a value that files hold as a word, as in `TwoSided` for `two-sided`.
fn word(value: &impl Serialize) -> String {
    let capital = |part: &str| part[..1].to_uppercase() + &part[1..];
    match serde_json::to_value(value) {
        Ok(Value::String(text)) => text.split('-').filter(|part| !part.is_empty()).map(capital).collect(),
        other => other.map(|value| value.to_string()).unwrap_or_default(),
    }
}

/// Standard types, whose text is Rust's.
macro_rules! plain {
    ($($name:ty),*) => {$(
        impl KeyText for $name {
            fn key_text(&self) -> String {
                format!("{self:?}")
            }
        }
    )*};
}
plain!(bool, u16, u32, u64, usize, f32, f64, String, (f64, f64, usize, usize, usize));

/// Types that files hold as words.
macro_rules! words {
    ($($name:ty),*) => {$(
        impl KeyText for $name {
            fn key_text(&self) -> String {
                word(self)
            }
        }
    )*};
}
words!(CfaPhase, Overlap, Tone, Shrinkage, Recurrence);

/// Structures: each field with its name in keys. A field that is missing here is an error of the compiler.
macro_rules! records {
    ($($type:ty as $name:literal { $($text:literal = $field:ident),* })*) => {$(
        impl KeyText for $type {
            fn key_text(&self) -> String {
                let Self { $($field),* } = self;
                record($name, &[$(($text, $field)),*])
            }
        }
    )*};
}
records! {
    Sensor as "Sensor" {
        "depth" = depth, "phase" = phase, "noise" = noise, "seed" = seed, "black_level" = black_level
    }
    Settings as "Settings" {
        "energy" = energy, "wavelength_tolerance" = wavelength_tolerance, "exact" = exact
    }
    Approximation as "Approximation" { "psf" = psf, "depth_tolerance" = depth_tolerance }
    Prior as "Prior" { "lambda" = lambda, "alpha" = alpha }
    blind::Settings as "Settings" {
        "side" = side, "sparsity" = sparsity, "kernel_weight" = kernel_weight, "turns" = turns,
        "outer" = outer, "inner" = inner, "step" = step, "turn_floor" = turn_floor, "floor" = floor,
        "min_part" = min_part, "prior" = prior
    }
    PictureModel as "PictureModel" {
        "contrast" = contrast, "unexplained" = unexplained, "middle_light" = middle_light
    }
    PursuitSettings as "PursuitSettings" {
        "pursuit" = pursuit, "depths" = depths, "window" = window, "stride" = stride
    }
    FloatSettings as "FloatSettings" {
        "stride" = stride, "overlap" = overlap, "output" = output, "budget" = budget
    }
    UntrainedSettings as "UntrainedSettings" {
        "layers" = layers, "dc_removed" = dc_removed, "penalty" = penalty, "depths" = depths,
        "window" = window, "float" = float
    }
}

impl KeyText for Form {
    /// States exposures where there are several, so that rows of one are recognised that were measured when there were no others.
    fn key_text(&self) -> String {
        let Self { window, codes, layers, shrinkage, recurrence, linear_path, tied, exposures } = self;
        let mut fields: Vec<(&str, &dyn KeyText)> = vec![
            ("window", window),
            ("codes", codes),
            ("layers", layers),
            ("shrinkage", shrinkage),
            ("recurrence", recurrence),
            ("linear_path", linear_path),
            ("tied", tied),
        ];
        fields.extend((*exposures != 1).then_some(("exposures", exposures as &dyn KeyText)));
        record("Form", &fields)
    }
}

impl<T: KeyText> KeyText for Option<T> {
    fn key_text(&self) -> String {
        self.as_ref().map_or_else(|| "None".to_owned(), |value| format!("Some({})", value.key_text()))
    }
}

impl<T: KeyText> KeyText for Vec<T> {
    fn key_text(&self) -> String {
        format!("[{}]", self.iter().map(KeyText::key_text).collect::<Vec<_>>().join(", "))
    }
}

impl<T: KeyText + Clone, const N: usize> KeyText for [T; N] {
    fn key_text(&self) -> String {
        self.to_vec().key_text()
    }
}

impl KeyText for Window {
    fn key_text(&self) -> String {
        format!("Window({})", self.side())
    }
}

impl KeyText for Stride {
    fn key_text(&self) -> String {
        format!("Stride({})", self.pixels())
    }
}

impl KeyText for Output {
    fn key_text(&self) -> String {
        match self {
            Self::Rgb => "Rgb",
            Self::Ycc422 => "Ycc422",
        }
        .to_owned()
    }
}

impl KeyText for Noise {
    fn key_text(&self) -> String {
        match self {
            Self::None => "None".to_owned(),
            Self::Gaussian { sigma } => record("Gaussian", &[("sigma", sigma)]),
            Self::Sensor(SensorNoise { full_well_e, read_noise_e, gain }) => {
                let fields: [(&str, &dyn KeyText); 3] =
                    [("full_well_e", full_well_e), ("read_noise_e", read_noise_e), ("gain", gain)];
                format!("Sensor({})", record("SensorNoise", &fields))
            }
        }
    }
}

impl KeyText for DeconvolutionSettings {
    fn key_text(&self) -> String {
        match self {
            Self::Wiener { model, noise } => record("Wiener", &[("model", model), ("noise", noise)]),
            Self::RichardsonLucy { steps } => record("RichardsonLucy", &[("steps", steps)]),
            Self::HyperLaplacian { model, share, alpha } => {
                record("HyperLaplacian", &[("model", model), ("share", share), ("alpha", alpha)])
            }
            Self::Blind(settings) => format!("Blind({})", settings.key_text()),
        }
    }
}

impl KeyText for Pursuit {
    fn key_text(&self) -> String {
        match self {
            Self::Omp { atoms } => record("Omp", &[("atoms", atoms)]),
            Self::Fista { steps, penalty, tolerance } => {
                record("Fista", &[("steps", steps), ("penalty", penalty), ("tolerance", tolerance)])
            }
        }
    }
}

impl KeyText for Depths {
    fn key_text(&self) -> String {
        match self {
            Self::Known => "Known".to_owned(),
            Self::Of(depths) => format!("Of({})", depths.key_text()),
        }
    }
}

impl KeyText for Condition {
    fn key_text(&self) -> String {
        let text = |noise: Noise| match noise {
            Noise::Gaussian { sigma } => number(sigma),
            other => other.to_string(),
        };
        let most = text(self.noise);
        match self.least_noise {
            Noise::None => format!("up to {most}"),
            least => format!("from {} up to {most}", text(least)),
        }
    }
}

impl KeyText for Camera {
    /// Returns text made from the camera's file, whose fields are stable. Of a height map and of the user's PSFs it holds the digests, which programs before
    /// version 1 did not.
    fn key_text(&self) -> String {
        let file = serde_json::to_value(self).unwrap_or_default();
        let text = |field: &str| format!("{field}: {}", literal(&file[field]));
        let or_none = |field: &str, of: &dyn Fn(&Value) -> String| match &file[field] {
            Value::Null => format!("{field}: None"),
            value => format!("{field}: Some({})", of(value)),
        };
        let list = |field: &str, of: &dyn Fn(&Value) -> String| {
            let items = file[field].as_array().map_or_else(Vec::new, |items| items.iter().map(of).collect());
            format!("{field}: [{}]", items.join(", "))
        };
        let spectrum = |value: &Value| {
            let name = if value.is_array() { "Sampled" } else { "Line" };
            format!("{name}({})", literal(value))
        };
        let sign = if file["defocus_sign"] == 1 { "Plus" } else { "Minus" };
        let fields = [
            text("name"),
            text("focal_length_mm"),
            text("aperture_radius_mm"),
            text("pixel_pitch_um"),
            list("spectra", &spectrum),
            text("reference_wavelength_nm"),
            format!("defocus_sign: {sign}"),
            text("focus_psi"),
            or_none("nominal_m", &literal),
            text("psi_range"),
            list("rings", &|ring| format!("Ring {}", ring_text(ring))),
            or_none("profile", &|profile| format!("Profile {}", fields(profile, &["at_nm", "points"]))),
            or_none("height_map", &literal),
            list("aberrations", &|term| format!("Aberration {}", fields(term, &["noll", "rms_nm"]))),
            or_none("psf_bank", &literal),
            text("source"),
        ];
        // What programs before version 1 did not have.
        let newer = file.get("mask").map(|terms| format!("mask: {}", literal(terms)));
        format!("Camera {{ {} }}", fields.into_iter().chain(newer).collect::<Vec<_>>().join(", "))
    }
}

fn ring_text(ring: &Value) -> String {
    let delay = match &ring["delay"]["etched"] {
        Value::Null => format!("Phase {}", fields(&ring["delay"]["phase"], &["rad", "at_nm"])),
        etched => format!("Etched {}", fields(etched, &["height_um", "cauchy"])),
    };
    format!("{{ inner: {}, outer: {}, delay: {delay} }}", literal(&ring["inner"]), literal(&ring["outer"]))
}

fn fields(value: &Value, names: &[&str]) -> String {
    let each: Vec<String> = names.iter().map(|name| format!("{name}: {}", literal(&value[*name]))).collect();
    format!("{{ {} }}", each.join(", "))
}

/// A value of a file as text; names of fields have no quotation marks.
fn literal(value: &Value) -> String {
    match value {
        Value::Object(all) => fields(value, &all.keys().map(String::as_str).collect::<Vec<_>>()),
        Value::Array(items) => format!("[{}]", items.iter().map(literal).collect::<Vec<_>>().join(", ")),
        Value::String(text) => format!("{text:?}"),
        Value::Number(number) if number.is_f64() => format!("{:?}", number.as_f64().unwrap_or_default()),
        other => other.to_string(),
    }
}
