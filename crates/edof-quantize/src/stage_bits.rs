//! Fewer bits in single stages: what each is worth, and the fewest that lose no more than is allowed.
//!
//! A stage of N bits has weights that are multiples of 2^k, k the bits left out, and results whose last k bits are left out, in the
//! range that they had; both are fixed networks as any other, so what they lose is measured on the golden pipeline itself.

use crate::evaluate::Scene;
use edof_core::{ColourFrame, ReconstructError};
use edof_golden::Golden;
use edof_network::FixedNetwork;
use edof_network::fixed_network::{FixedMatrix, FixedNetworkError};
use rayon::prelude::*;

/// Fewest bits that are tried.
pub const MIN: u32 = 5;

/// Bits that cannot be tried.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum StageBitsError {
    /// Not one a stage, or out of range.
    #[error("bits {bits:?}: must be {stages} of them, one a stage, from {MIN} to the network's {max}")]
    Bits { bits: Vec<u32>, stages: usize, max: u32 },
    /// No network that runs exactly; the difference form needs one format for all codes.
    #[error(transparent)]
    Network(#[from] FixedNetworkError),
    /// A scene that is too small.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
}

/// The network with N bits in the weights and results of I, each M and F; F's results keep theirs. A matrix that several stages
/// share has the most that any of them asks for.
///
/// # Errors
/// [`StageBitsError`].
pub fn with_stage_bits(fixed: &FixedNetwork, bits: &[u32]) -> Result<FixedNetwork, StageBitsError> {
    let (stages, max) = (fixed.form.layers, fixed.code_bits);
    if bits.len() != stages || bits.iter().any(|b| !(MIN..=max).contains(b)) {
        return Err(StageBitsError::Bits { bits: bits.to_vec(), stages, max });
    }
    let left_out = |stage: usize| max - bits[stage];
    let mut network = fixed.clone();
    coarsen(&mut network.analysis, left_out(0), max);
    for index in 0..network.recurrent.len() {
        let uses =
            (0..fixed.form.middle_layers()).filter(|layer| fixed.form.recurrent_index(*layer) == index);
        let min = uses.map(|layer| left_out(layer + 1)).min().unwrap_or(0);
        coarsen(&mut network.recurrent[index], min, max);
    }
    coarsen(&mut network.dictionary, left_out(stages - 1), max);
    network.linear_path.iter_mut().for_each(|r| coarsen(r, left_out(stages - 1), max));
    for (stage, theta) in network.thresholds.iter_mut().enumerate() {
        // Below no fraction bits at all there is nothing to leave out.
        let k = left_out(stage).min(network.code_fractions[stage]);
        network.code_fractions[stage] -= k;
        theta.mapv_inplace(|word| shifted(word, k));
    }
    checked(network)
}

/// Codes of few bits are counted as if they filled their words, so F's sums may seem too wide beside R's fine products: R then gives up
/// fraction bits until they are not, as it does when a network is quantized.
fn checked(mut network: FixedNetwork) -> Result<FixedNetwork, StageBitsError> {
    loop {
        match (network.check(), &mut network.linear_path) {
            (Err(FixedNetworkError::Overflow { what: "F", .. }), Some(r)) if r.fraction > 0 => {
                r.fraction -= 1;
                r.weights.mapv_inplace(|word| shifted(word, 1));
            }
            (checked, _) => return Ok(checked.map(|()| network)?),
        }
    }
}

/// Nearest, ties up.
fn shifted(word: i16, k: u32) -> i16 {
    let half = if k == 0 { 0 } else { 1i32 << (k - 1) };
    ((i32::from(word) + half) >> k) as i16
}

fn coarsen(matrix: &mut FixedMatrix, k: u32, bits: u32) {
    let max = ((1i32 << (bits - 1)) - 1) >> k;
    matrix.weights.mapv_inplace(|word| (i32::from(shifted(word, k)).min(max) << k) as i16);
}

/// Mean PSNR of a network over scenes; `psnr(sharp, estimate)` in dB compares pictures in the tone of the sharp one.
///
/// # Errors
/// [`StageBitsError`]; what `psnr` returns.
pub fn mean_db<E: From<StageBitsError> + Send>(
    network: FixedNetwork,
    scenes: &[Scene<'_>],
    psnr: impl Fn(&ColourFrame, &ColourFrame) -> Result<f64, E> + Sync,
) -> Result<f64, E> {
    let golden = Golden::new(network).map_err(StageBitsError::from)?;
    let db = |scene: &Scene<'_>| {
        let light = golden.frame_of_light(&scene.raw).map_err(ReconstructError::from);
        psnr(scene.sharp, &scene.tone.encoded(&light.map_err(StageBitsError::from)?.1))
    };
    let all: Vec<f64> = scenes.par_iter().map(db).collect::<Result<_, E>>()?;
    Ok(all.iter().sum::<f64>() / all.len().max(1) as f64)
}

/// From `bits` in all stages, in turn the bit whose loss is least is taken out, as long as all together lose no more than `allowed` dB;
/// `db(bits)` measures. Gives the bits, and the dB that they lose.
///
/// # Errors
/// What measuring says.
pub fn fewest<E>(
    bits: u32,
    stages: usize,
    allowed: f64,
    mut db: impl FnMut(&[u32]) -> Result<f64, E>,
) -> Result<(Vec<u32>, f64), E> {
    let mut best = vec![bits; stages];
    let (whole, mut lost) = (db(&best)?, 0.0);
    loop {
        let mut next: Option<(usize, f64)> = None;
        for stage in (0..stages).filter(|stage| best[*stage] > MIN) {
            let mut fewer = best.clone();
            fewer[stage] -= 1;
            let own = whole - db(&fewer)?;
            if own <= allowed && next.is_none_or(|(_, min)| own < min) {
                next = Some((stage, own));
            }
        }
        let Some((stage, own)) = next else { return Ok((best, lost)) };
        best[stage] -= 1;
        lost = own;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_bits_are_the_network_itself_and_fewer_are_multiples() {
        let fixed = edof_device::random::natural(8, 8, 1);
        assert_eq!(with_stage_bits(&fixed, &[16; 4]).unwrap(), fixed);
        let coarse = with_stage_bits(&fixed, &[12, 16, 10, 16]).unwrap();
        assert!(
            coarse.analysis.weights.iter().all(|w| w % 16 == 0)
                && coarse.analysis.weights != fixed.analysis.weights
        );
        assert_eq!(coarse.recurrent[0], fixed.recurrent[0]);
        assert!(coarse.recurrent[1].weights.iter().all(|w| w % 64 == 0));
        assert_eq!(coarse.code_fractions, [11, 14, 8]);
        assert!(with_stage_bits(&fixed, &[16; 3]).unwrap_err().to_string().contains("must be 4 of them"));
        assert!(with_stage_bits(&fixed, &[17; 4]).is_err());
    }

    #[test]
    fn bits_go_where_they_cost_least_until_no_more_is_allowed() {
        // The first stage loses 0.01 dB a bit, the second 0.004.
        let db = |bits: &[u32]| {
            Ok::<f64, ()>(30.0 - 0.01 * f64::from(16 - bits[0]) - 0.004 * f64::from(16 - bits[1]))
        };
        let (bits, lost) = fewest(16, 2, 0.021, db).unwrap();
        assert_eq!(bits, [16, 11]);
        assert!((lost - 0.02).abs() < 1e-9);
    }

    fn small(layers: usize, tied: bool) -> FixedNetwork {
        let form = edof_network::network::Form {
            window: edof_core::Window::new(8).unwrap(),
            codes: 2,
            layers,
            shrinkage: edof_network::network::Shrinkage::OneSided,
            recurrence: edof_network::network::Recurrence::Direct,
            linear_path: true,
            tied,
            exposures: 1,
        };
        edof_device::random::extreme(form, 8, edof_core::Stride::PATCH, false, 2)
    }

    #[test]
    fn bits_are_left_out_to_the_nearest_with_ties_up_and_within_the_range() {
        let cases = [(5, 1, 3), (-5, 1, -2), (7, 0, 7), (6, 2, 2), (5, 2, 1), (-6, 2, -1), (-7, 2, -2)];
        for (word, k, expected) in cases {
            assert_eq!(shifted(word, k), expected, "{word} {k}");
        }
        assert_eq!(shifted(i16::MAX, 15), 1);
        let mut matrix = FixedMatrix { weights: ndarray::array![[127, -128, 5, -7, 121, 3]], fraction: 4 };
        coarsen(&mut matrix, 2, 8);
        assert_eq!(matrix.weights, ndarray::array![[124, -128, 4, -8, 120, 4]]);
        assert_eq!(matrix.fraction, 4);
    }

    #[test]
    fn every_stage_has_its_own_bits_and_a_shared_matrix_the_most() {
        let fixed = small(5, false);
        let coarse = |m: &FixedMatrix, k| {
            let mut m = m.clone();
            coarsen(&mut m, k, 8);
            m
        };
        let found = with_stage_bits(&fixed, &[8, 7, 6, 5, 6]).unwrap();
        assert_eq!(found.analysis, fixed.analysis);
        for (i, k) in [1, 2, 3].into_iter().enumerate() {
            assert_eq!(found.recurrent[i], coarse(&fixed.recurrent[i], k));
        }
        assert_eq!(found.dictionary, coarse(&fixed.dictionary, 2));
        assert_eq!(found.linear_path, fixed.linear_path.as_ref().map(|r| coarse(r, 2)));
        for (t, k) in [0, 1, 2, 3].into_iter().enumerate() {
            assert_eq!(found.code_fractions[t], fixed.code_fractions[t] - k);
            assert_eq!(found.thresholds[t], fixed.thresholds[t].mapv(|w| shifted(w, k)));
        }
        let tied = small(5, true);
        let found = with_stage_bits(&tied, &[5, 6, 7, 5, 8]).unwrap();
        assert_eq!(found.recurrent, [coarse(&tied.recurrent[0], 1)]);
        assert_eq!(found.analysis, coarse(&tied.analysis, 3));
        assert_eq!(found.dictionary, tied.dictionary);
    }

    #[test]
    fn codes_without_fraction_bits_have_none_to_leave_out() {
        let mut fixed = small(2, false);
        fixed.code_fractions = vec![2];
        let found = with_stage_bits(&fixed, &[5, 8]).unwrap();
        assert_eq!(found.code_fractions, [0]);
        assert_eq!(found.thresholds[0], fixed.thresholds[0].mapv(|w| shifted(w, 2)));
        let refused = |bits: &[u32]| with_stage_bits(&fixed, bits).unwrap_err().to_string();
        assert_eq!(
            refused(&[4, 8]),
            "bits [4, 8]: must be 2 of them, one a stage, from 5 to the network's 8"
        );
        assert!(refused(&[8, 9]).starts_with("bits [8, 9]"));
        assert!(refused(&[8]).starts_with("bits [8]"));
    }

    #[test]
    fn a_linear_path_gives_up_fraction_bits_until_sums_fit_and_no_more() {
        let mut fixed = small(2, false);
        fixed.code_fractions = vec![10];
        fixed.dictionary.fraction = 5;
        let r = fixed.linear_path.as_mut().unwrap();
        (r.fraction, r.weights) = (40, r.weights.mapv(|_| 101));
        let found = checked(fixed.clone()).unwrap();
        let taken = 40 - found.linear_path.as_ref().unwrap().fraction;
        let halved = |times: u32| (0..times).fold(101, |word, _| shifted(word, 1));
        assert!(taken > 0 && found.linear_path.as_ref().unwrap().weights.iter().all(|w| *w == halved(taken)));
        let mut before = fixed.clone();
        let r = before.linear_path.as_mut().unwrap();
        (r.fraction, r.weights) = (40 - (taken - 1), r.weights.mapv(|_| halved(taken - 1)));
        assert!(matches!(before.check(), Err(FixedNetworkError::Overflow { what: "F", .. })));
        assert_eq!(FixedNetwork { linear_path: fixed.linear_path.clone(), ..found }, fixed);
        // Here D is the finer one, and nothing that R could give up helps.
        fixed.code_fractions = vec![12];
        fixed.dictionary.fraction = 48;
        fixed.linear_path.as_mut().unwrap().fraction = 0;
        assert!(matches!(
            checked(fixed),
            Err(StageBitsError::Network(FixedNetworkError::Overflow { what: "F", .. }))
        ));
    }

    #[test]
    fn the_mean_is_over_scenes_in_their_tone() {
        let sharp = [0.25, 0.75].map(|v| ColourFrame { planes: ndarray::Array3::from_elem((3, 16, 16), v) });
        let raw = edof_core::RawFrame::from_values(
            ndarray::Array2::from_elem((16, 16), 1000),
            12,
            edof_core::CfaPhase::Rggb,
        );
        let raw = raw.unwrap();
        let scene = |sharp, tone| Scene { name: String::new(), raw: raw.clone(), sharp, tone };
        let scenes = [scene(&sharp[0], edof_core::Tone::Linear), scene(&sharp[1], edof_core::Tone::Srgb)];
        let network = edof_device::random::natural(8, 8, 1);
        let of = |picture: &ColourFrame| f64::from(picture.planes.mean().unwrap());
        let psnr =
            |sharp: &ColourFrame, other: &ColourFrame| Ok::<_, StageBitsError>(8.0 * of(sharp) + of(other));
        let light = Golden::new(network.clone()).unwrap().frame(&raw).unwrap().colour();
        let expected = 0.5 * (2.0 + of(&light) + 6.0 + of(&edof_core::Tone::Srgb.encoded(&light)));
        let found = mean_db(network.clone(), &scenes, psnr).unwrap();
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        assert_eq!(mean_db(network, &[], psnr), Ok(0.0));
    }

    #[test]
    fn equal_losses_fall_on_the_first_stage_and_never_below_the_fewest_bits() {
        let db =
            |bits: &[u32]| Ok::<f64, ()>(30.0 - bits.iter().map(|b| 0.25 * f64::from(8 - b)).sum::<f64>());
        assert_eq!(fewest(8, 2, 0.25, db), Ok((vec![7, 8], 0.25)));
        assert_eq!(fewest(8, 2, 0.24, db), Ok((vec![8, 8], 0.0)));
        assert_eq!(fewest(8, 2, 0.75, db), Ok((vec![5, 8], 0.75)));
        assert_eq!(fewest(8, 2, 100.0, db), Ok((vec![MIN, MIN], 1.5)));
        let broken = |bits: &[u32]| if bits == [8, 8] { Ok(30.0) } else { Err("broken") };
        assert_eq!(fewest(8, 2, 1.0, broken), Err("broken"));
    }
}
