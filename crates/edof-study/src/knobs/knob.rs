//! A knob, what it turns, and what is run there.

use crate::key::{KeyText, record};
use crate::methods::dictionary::Dictionary;
use crate::methods::spec::MethodSpec;
use edof_core::Noise;
use edof_core::camera::Camera;
use edof_network::{FixedNetwork, Network};
use edof_optics::capture::Approximation;
use std::sync::Arc;

/// What can be turned. Knobs are identified by their names.
pub struct Knob {
    /// What users call it.
    pub name: &'static str,
    /// What its numbers are.
    pub unit: &'static str,
    /// Where it is tried, besides its default.
    pub values: &'static [f64],
    /// Where it stands, asked from the code that uses it.
    pub default: fn(&Plan) -> f64,
    /// What it is, and why its default stands where it does.
    pub why: &'static str,
    /// What runs where it stands at a value.
    pub apply: fn(&Plan, f64) -> Work,
    /// Whether its curve is plotted against time. Where the knob does not change what a program does, times differ only by chance.
    pub takes_time: bool,
    /// Numbers of bits in which it needs the plan's network.
    pub bits: &'static [u32],
}

impl Knob {
    /// Where it is tried: its values, and its default if that is not among them.
    #[must_use]
    pub fn values(&self, plan: &Plan) -> Vec<f64> {
        let default = (self.default)(plan);
        let other = Some(default).filter(|default| !self.values.contains(default));
        self.values.iter().copied().chain(other).collect()
    }
}

/// What is measured.
pub struct Plan {
    /// The camera.
    pub camera: Camera,
    /// Depth; the knob of depths takes the camera's range.
    pub psi: f64,
    /// Noise, where something is reconstructed.
    pub noise: Noise,
    /// The float network of strides.
    pub network: Arc<Network>,
    /// SHA-256 of its file.
    pub network_sha256: String,
    /// The same network in integers, for each number of [`Knob::bits`] of its knobs.
    pub fixed: Vec<FixedNetwork>,
    /// Atoms of pursuits.
    pub dictionary: Arc<Dictionary>,
    /// Which knobs.
    pub knobs: Vec<&'static Knob>,
}

impl Plan {
    /// The network in N bits.
    ///
    /// # Panics
    /// If the plan has none of these.
    #[must_use]
    pub fn in_bits(&self, bits: u32) -> &FixedNetwork {
        let network = self.fixed.iter().find(|fixed| fixed.code_bits == bits);
        network.unwrap_or_else(|| unreachable!("a plan has a network of every number of bits"))
    }
}

/// What a knob at a value runs.
pub enum Work {
    /// A capture, held against a reference.
    Capture(Box<Shortened>),
    /// A method on the usual capture.
    Method(MethodSpec),
}

/// A shortened capture and the one that it is held against.
pub struct Shortened {
    /// The camera.
    pub camera: Camera,
    /// How exactly the shortened one is computed.
    pub cut: Approximation,
    /// How exactly the other one is.
    pub reference: Approximation,
    /// Layers of the scene and of the reference, where it has many depths.
    pub layers: Option<[usize; 2]>,
}

impl KeyText for Shortened {
    fn key_text(&self) -> String {
        let Self { camera, cut, reference, layers } = self;
        let fields: [(&str, &dyn KeyText); 4] =
            [("camera", camera), ("cut", cut), ("reference", reference), ("layers", layers)];
        record("Shortened", &fields)
    }
}
