//! The specification: one window through the integer network, one line of code for one line of
//! [`edof_network::fixed_network`]. Slow and plain on purpose; [`crate::fast`] must give the same [`Trace`].

use crate::trace::{LayerWords, StageCounts, Trace};
use edof_core::number::{InputWord, OutputWord, bits_of, requantize, saturate};
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedMatrix;
use edof_network::network::Recurrence;

/// Bits of an output word.
const OUTPUT_BITS: u32 = 16;

/// Runs the network on a window's input words (`window.pixels()` of them) and keeps every boundary.
#[must_use]
pub fn run(network: &FixedNetwork, window: &[InputWord]) -> Trace {
    let (y, code_bits) = (bits_of(window), network.code_bits);
    let shift = network.analysis_shift();
    let mut layers: Vec<LayerWords> = Vec::with_capacity(network.form.shrinkages());
    let mut stages = vec![StageCounts::default(); network.form.layers];

    for t in 0..network.form.shrinkages() {
        let counts = &mut stages[t];
        let b: Vec<i16> = (0..network.form.codes)
            .map(|row| {
                let (word, saturated) = if t == 0 {
                    requantize(product(&network.analysis, row, y), shift, code_bits)
                } else {
                    let (before, shifts) = (&layers[t - 1], network.middle_shifts(t - 1));
                    let base = match network.form.recurrence {
                        Recurrence::Direct => layers[0].b[row],
                        Recurrence::Difference => before.b[row],
                    };
                    let sum = product(network.recurrent_matrix(t - 1), row, &before.sent);
                    requantize((i64::from(base) << shifts.base) + sum, shifts.result, code_bits)
                };
                counts.saturated_results += u64::from(saturated);
                word
            })
            .collect();
        let z: Vec<i16> = b
            .iter()
            .zip(&network.thresholds[t])
            .map(|(&b, &theta)| {
                let (word, saturated) = network.form.shrinkage.word(b, theta, code_bits);
                counts.saturated_codes += u64::from(saturated);
                word
            })
            .collect();
        let sent: Vec<i16> = if sends_difference(network, t) {
            (0..z.len())
                .map(|i| {
                    let before = if t == 0 { 0 } else { layers[t - 1].z[i] };
                    let (word, saturated) = saturate(i64::from(z[i]) - i64::from(before), code_bits);
                    counts.saturated_differences += u64::from(saturated);
                    word
                })
                .collect()
        } else {
            z.clone()
        };
        counts.nonzeros = sent.iter().filter(|v| **v != 0).count() as u64;
        layers.push(LayerWords { b, z, sent });
    }

    let shifts = network.final_shifts();
    let z = &layers[layers.len() - 1].sent;
    let counts = &mut stages[network.form.layers - 1];
    let output = (0..network.dictionary.weights.nrows())
        .map(|row| {
            let dictionary = product(&network.dictionary, row, z) << shifts.dictionary;
            let linear = network.linear_path.as_ref().map_or(0, |r| product(r, row, y) << shifts.linear_path);
            let (word, saturated) = requantize(dictionary + linear, shifts.result, OUTPUT_BITS);
            counts.saturated_results += u64::from(saturated);
            OutputWord::from_bits(word)
        })
        .collect();
    Trace { input: window.to_vec(), layers, output, stages }
}

/// Whether stage `t` (0 = I) sends z_t − z_{t−1}: in the difference form, where the next stage is an M.
#[must_use]
pub fn sends_difference(network: &FixedNetwork, t: usize) -> bool {
    network.form.recurrence == Recurrence::Difference && t + 1 < network.form.shrinkages()
}

/// Σ w·v over one row.
fn product(matrix: &FixedMatrix, row: usize, v: &[i16]) -> i64 {
    matrix.weights.row(row).iter().zip(v).map(|(w, v)| i64::from(i32::from(*w) * i32::from(*v))).sum()
}
