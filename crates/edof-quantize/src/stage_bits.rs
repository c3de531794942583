//! Fewer bits in single stages: what each is worth, and the fewest that lose no more than is allowed.
//!
//! A stage of N bits has weights that are multiples of 2^k, k the bits left out, and results whose last k bits are left out, in the
//! range that they had; both are fixed networks as any other, so what they lose is measured on the golden pipeline itself.

use crate::evaluate::Scene;
use edof_golden::Golden;
use edof_image::{ColourFrame, ReconstructError};
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
/// [`StageBitsError`].
pub fn mean_db(
    network: FixedNetwork,
    scenes: &[Scene<'_>],
    psnr: impl Fn(&ColourFrame, &ColourFrame) -> f64 + Sync,
) -> Result<f64, StageBitsError> {
    let golden = Golden::new(network)?;
    let db = |scene: &Scene<'_>| {
        let picture = golden.frame(&scene.raw).map_err(ReconstructError::from)?.colour();
        Ok(psnr(scene.sharp, &scene.tone.encoded(&picture)))
    };
    let all: Vec<f64> = scenes.par_iter().map(db).collect::<Result<_, ReconstructError>>()?;
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
        let fixed = edof_random::natural(8, 8, 1);
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
}
