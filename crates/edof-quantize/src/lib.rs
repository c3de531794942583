//! From a float network to the board's integers (docs/contract.md).
//!
//! | step | module | gives |
//! |---|---|---|
//! | scenes | [`mod@capture`] | sharp pictures behind the network's own camera, over its range of ψ and noise |
//! | measure | [`calibration`] | the largest |b|, |z| of every coefficient on real raw frames |
//! | fold | [`fold`] | 4:2:2, chroma gain and averaging window inside D and R; equal ranges inside A, θ, S, D |
//! | formats | [`formats`] | fraction bits of every layer and matrix, legal shifts, integers |
//! | round | [`rounding`] | weights rounded so that their errors hide in what they are multiplied with |
//! | tune | [`mod@finetune`] | weights that have learned to live with few bits, by the gradient of [`simulated`] |
//! | bound | [`mod@bounds`] | how far off any window can be, stage by stage, against real numbers ([`float_reference`]) |
//! | leave out | [`stage_bits`] | fewer bits in single stages, and the fewest that lose no more than is allowed |
//! | check | [`mod@evaluate`] | dB lost and saturations, against the float network in the board's own output format |
//!
//! Ranges are measured on the float network, so that integers hold every value seen, times a headroom. All layers share the
//! coefficients' scales (b₁ feeds every one of them); what differs from layer to layer is the count of fraction bits.
//!
//! ```
//! use edof_quantize::{Calibration, QuantizeOptions, quantize};
//! # fn show(network: &edof_network::Network, frames: &[edof_core::RawFrame]) -> Result<(), Box<dyn std::error::Error>> {
//! let seen = Calibration::measure(network, frames)?;
//! let (fixed, layers) = quantize(network, &QuantizeOptions::default(), &seen, "the weight file's hash")?;
//! assert!(layers.iter().all(|layer| layer.accumulator_bits <= 48));
//! assert_eq!(fixed.code_bits, 16);
//! # Ok(())
//! # }
//! ```
//!
//! # Stability
//!
//! Stable: files of fixed networks. Signatures may change between minor versions until 1.0; `examples/lens_to_picture.rs` goes from a lens to a picture in thirty lines.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod bounds;
pub mod calibration;
pub mod capture;
pub mod evaluate;
pub mod finetune;
pub mod float_reference;
pub mod fold;
pub mod formats;
pub mod rounding;
pub mod simulated;
pub mod stage_bits;

pub use calibration::Calibration;
pub use capture::capture;
pub use evaluate::{Evaluation, Scene, evaluate};
pub use finetune::{FinetuneOptions, FinetuneProgress, finetune};

use edof_core::Stride;
use edof_core::geometry::GeometryError;
use edof_core::overlap::Overlap;
use edof_network::fixed_network::{FixedNetworkError, WORD_BITS, layer_names};
use edof_network::network::NetworkError;
use edof_network::{FixedNetwork, Network};

/// What to make of a float network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantizeOptions {
    /// Bits of every weight and code, 8…16.
    pub bits: u32,
    /// Stride that the averaging window is made for.
    pub stride: Stride,
    /// Averaging window.
    pub overlap: Overlap,
    /// Codes may be this much larger than calibration saw before they saturate; 1 or more.
    pub headroom: f64,
}

impl Default for QuantizeOptions {
    fn default() -> Self {
        Self { bits: WORD_BITS, stride: Stride::PATCH, overlap: Overlap::Hann, headroom: 2.0 }
    }
}

impl QuantizeOptions {
    /// # Errors
    /// [`QuantizeError`] for a width or headroom out of range.
    pub fn check(&self) -> Result<(), QuantizeError> {
        if self.headroom.is_nan() || self.headroom < 1.0 {
            return Err(QuantizeError::Headroom(self.headroom));
        }
        if !(8..=16).contains(&self.bits) {
            let source = FixedNetworkError::CodeBits(self.bits);
            return Err(QuantizeError::Fixed { bits: self.bits, source });
        }
        Ok(())
    }
}

/// A network that cannot be quantized so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum QuantizeError {
    /// The float network does not fit its form.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// A frame too small for the network's window.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// No integers of this width run exactly.
    #[error("{bits} bits: {source}")]
    Fixed { bits: u32, source: FixedNetworkError },
    /// A weight is too large for the width, even without fraction bits.
    #[error("{what}: value {value} does not fit {bits} bits after range equalisation")]
    Large { what: &'static str, value: f64, bits: u32 },
    /// Headroom below one.
    #[error("headroom {0}: must be 1 or more")]
    Headroom(f64),
    /// Calibration saw nothing, or another form.
    #[error("calibration: {0}")]
    Calibration(&'static str),
}

/// Formats of one layer, as chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerReport {
    /// I, M1, M2, …, F.
    pub name: String,
    /// Largest share of a code's range that calibration used, over all coefficients; none for F.
    pub range_used: Option<f64>,
    /// Fraction bits of the result.
    pub result_fraction: u32,
    /// Fraction bits of the weights; F has D's and, with a linear path, R's.
    pub weight_fractions: Vec<u32>,
    /// Right shift from accumulator to result.
    pub shift: u32,
    /// Bits that the accumulator needs for the worst input there is.
    pub accumulator_bits: u32,
}

/// Quantizes a network for ranges that `calibration` measured on it. `float_hash` is the SHA-256 of its weight file.
///
/// # Errors
/// [`QuantizeError`].
pub fn quantize(
    network: &Network,
    options: &QuantizeOptions,
    calibration: &Calibration,
    float_hash: &str,
) -> Result<(FixedNetwork, Vec<LayerReport>), QuantizeError> {
    network.check()?;
    calibration.check(&network.form)?;
    options.check()?;
    let scales = fold::scales(network, calibration, options);
    let folded = fold::fold(network, &scales, options.stride, options.overlap);
    let used = formats::used(calibration, &scales);
    let rounding = rounding::Rounding::new(calibration, &scales, &network.form);
    let fixed = formats::integers(&folded, &used, &rounding, network, options, float_hash)?;
    let report = report(&fixed, &used);
    Ok((fixed, report))
}

fn report(fixed: &FixedNetwork, used: &[f64]) -> Vec<LayerReport> {
    let layers = fixed.form.layers;
    let bits = fixed.accumulator_bits();
    layer_names(layers)
        .enumerate()
        .zip(bits)
        .map(|((layer, name), accumulator_bits)| {
            let full = f64::from(1u32 << (fixed.code_bits - 1)) - 1.0;
            let code = |t: usize| {
                let fraction = fixed.code_fractions[t];
                (Some(used[t] * f64::from(fraction).exp2() / full), fraction)
            };
            let ((range_used, result_fraction), weight_fractions, shift, name) = match layer {
                0 => (code(0), vec![fixed.analysis.fraction], fixed.analysis_shift(), name.to_owned()),
                _ if layer + 1 == layers => {
                    let weights = std::iter::once(&fixed.dictionary).chain(&fixed.linear_path);
                    let fraction = edof_core::number::OUTPUT_FRACTION;
                    let weights = weights.map(|m| m.fraction).collect();
                    ((None, fraction), weights, fixed.final_shifts().result, name.to_owned())
                }
                _ => {
                    let weights = vec![fixed.recurrent_matrix(layer - 1).fraction];
                    (code(layer), weights, fixed.middle_shifts(layer - 1).result, format!("{name}{layer}"))
                }
            };
            LayerReport { name, range_used, result_fraction, weight_fractions, shift, accumulator_bits }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_states_the_formats_of_every_layer() {
        let mut fixed = edof_device::random::natural(8, 8, 1);
        fixed.recurrent[1].fraction = 15;
        let bits = fixed.accumulator_bits();
        let layer =
            |layer: usize, name: &str, share: Option<f64>, fraction, weights: &[u32], shift| LayerReport {
                name: name.to_owned(),
                range_used: share.map(|share| share / 32767.0),
                result_fraction: fraction,
                weight_fractions: weights.to_vec(),
                shift,
                accumulator_bits: bits[layer],
            };
        let expected = [
            layer(0, "I", Some(0.5 * 32768.0), 15, &[17], 17),
            layer(1, "M1", Some(0.75 * 16384.0), 14, &[16], 17),
            layer(2, "M2", Some(0.125 * 16384.0), 14, &[15], 15),
            layer(3, "F", None, 14, &[15, 20], 21),
        ];
        assert_eq!(report(&fixed, &[0.5, 0.75, 0.125]), expected);
        fixed.linear_path = None;
        let last = report(&fixed, &[0.5, 0.75, 0.125]).pop().unwrap();
        assert_eq!((last.weight_fractions, last.shift), (vec![15], 15));
    }

    #[test]
    fn options_are_refused_just_outside_their_range() {
        let check = |bits, headroom| QuantizeOptions { bits, headroom, ..QuantizeOptions::default() }.check();
        assert_eq!(QuantizeOptions::default().check(), Ok(()));
        assert_eq!((check(8, 1.0), check(16, 1.0)), (Ok(()), Ok(())));
        for bits in [7, 17] {
            let source = FixedNetworkError::CodeBits(bits);
            assert_eq!(check(bits, 2.0), Err(QuantizeError::Fixed { bits, source }));
        }
        assert_eq!(check(16, 0.999), Err(QuantizeError::Headroom(0.999)));
        assert!(matches!(check(16, f64::NAN), Err(QuantizeError::Headroom(_))));
    }
}
