//! What must be rejected, in words that name what is wrong.

use crate::metrics::Quality;
use crate::stability::bench::Bench;
use crate::stability::case::Refusal;
use crate::stability::outcome::{Stopped, TrialResult};
use edof_core::camera::Camera;
use edof_core::{CfaPhase, ColourFrame, Noise, RawFrame, Stride, Tone, Window};
use edof_golden::{ColourTable, Golden};
use edof_network::FixedNetwork;
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_optics::Scene;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use edof_optics::{Sensor, expose};
use edof_quantize::QuantizeOptions;
use ndarray::Array2;

/// Runs it; returns the error message, unless the input was accepted.
pub(crate) fn refusal(bench: &Bench, given: Refusal) -> Result<TrialResult, Stopped> {
    let passed = || Ok(TrialResult::default());
    match given {
        Refusal::WideSums => refused(|n| {
            n.analysis.weights.fill(i16::MAX);
            n.recurrent[0].weights.fill(i16::MAX);
            n.recurrent[0].fraction = 33;
            n.code_fractions.fill(15);
            n.analysis.fraction = 15;
        }),
        Refusal::LongShift => refused(|n| n.analysis.fraction = 48),
        Refusal::NegativeShift => refused(|n| {
            n.analysis.fraction = 0;
            n.code_fractions[0] = 20;
        }),
        Refusal::WideWeight => refused(|n| {
            n.code_bits = 12;
            n.analysis.weights[(0, 0)] = 3000;
        }),
        Refusal::NegativeThreshold => refused(|n| {
            n.form.shrinkage = Shrinkage::TwoSided;
            n.thresholds[0].fill(-1);
        }),
        Refusal::UnequalFractions => refused(|n| {
            n.form.recurrence = Recurrence::Difference;
            n.code_fractions[1] = n.code_fractions[0] - 1;
        }),
        Refusal::WeightNoNumber => float(bench, |n| n.analysis[(0, 0)] = f32::NAN),
        Refusal::InfiniteThreshold => float(bench, |n| n.thresholds[0][0] = f32::INFINITY),
        Refusal::FewLayers => float(bench, |n| n.form.layers = 1),
        Refusal::FewBits => QuantizeOptions { bits: 7, ..QuantizeOptions::default() }
            .check()
            .map_err(Into::into)
            .and(passed()),
        Refusal::Headroom => {
            let options = QuantizeOptions { headroom: f64::NAN, ..QuantizeOptions::default() };
            options.check().map_err(Into::into).and(passed())
        }
        Refusal::SensorBits => shot(&Sensor { depth: 7, ..Sensor::default() }),
        Refusal::MuchNoise => shot(&Sensor { noise: Noise::gaussian(1.5), ..Sensor::default() }),
        Refusal::LessThanAnElectron => shot(&Sensor { noise: Noise::sensor(20_000.0), ..Sensor::default() }),
        Refusal::WideValue => {
            let values = Array2::from_elem((4, 4), 256);
            RawFrame::from_values(values, 8, CfaPhase::Rggb).map_err(Into::into).and(passed())
        }
        Refusal::CameraNoNumber => {
            let mut camera = Camera::resolve("ring-outer")?;
            camera.focal_length_mm = f64::NAN;
            camera.check().map_err(Into::into).and(passed())
        }
        Refusal::PsiNoNumber => {
            let camera = Camera::resolve("ring-outer")?;
            channel_psfs(&camera, f64::NAN, &Settings::default()).map_err(Into::into).and(passed())
        }
        Refusal::ScenePsiNoNumber => Scene::flat("case", ColourFrame::zeros(8, 8), f64::INFINITY)
            .check()
            .map_err(Into::into)
            .and(passed()),
        Refusal::KernelSum => Psf::new(Array2::from_elem((3, 3), 0.2)).map_err(Into::into).and(passed()),
        Refusal::KernelSide => {
            Psf::new(Array2::from_elem((4, 4), 1.0 / 16.0)).map_err(Into::into).and(passed())
        }
        Refusal::ShortTable => ColourTable::from_entries(vec![0; 7]).map_err(Into::into).and(passed()),
        Refusal::WideEntry => ColourTable::from_entries(vec![4096; 16_384]).map_err(Into::into).and(passed()),
        Refusal::TwoSizes => compared((40, 40), (40, 42)),
        Refusal::SmallPicture => compared((20, 20), (20, 20)),
    }
}

/// A random network, spoiled.
fn refused(spoil: impl FnOnce(&mut FixedNetwork)) -> Result<TrialResult, Stopped> {
    let form = Form {
        window: Window::new(8)?,
        codes: 16,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let mut network = edof_device::random::extreme(form, 16, Stride::PATCH, false, 2);
    network.check()?;
    spoil(&mut network);
    Golden::new(network)?;
    Ok(TrialResult::default())
}

/// The first trained network, spoiled.
fn float(bench: &Bench, spoil: impl FnOnce(&mut edof_network::Network)) -> Result<TrialResult, Stopped> {
    let Some(trained) = bench.networks.first() else { return Ok(TrialResult::default()) };
    let mut network = trained.float.clone();
    network.check()?;
    spoil(&mut network);
    network.check()?;
    Ok(TrialResult::default())
}

fn shot(sensor: &Sensor) -> Result<TrialResult, Stopped> {
    expose(&ColourFrame::zeros(8, 8), sensor)?;
    Ok(TrialResult::default())
}

fn compared(a: (usize, usize), b: (usize, usize)) -> Result<TrialResult, Stopped> {
    Quality::of(&ColourFrame::zeros(a.0, a.1), &ColourFrame::zeros(b.0, b.1), 8, Tone::Linear)?;
    Ok(TrialResult::default())
}
