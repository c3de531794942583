//! Networks of words on windows that drive their sums and saturations to the ends, against sums in integers of 128 bits.
//!
//! Every stage is computed again from the words that the network says went into it: sums without a width, floor division for the shift,
//! and a clamp. Words and counts of saturations must be the same, no sum may be larger than the bits of its accumulator allow, and
//! the bounds against real numbers hold here too.

use crate::stability::bench::Bench;
use crate::stability::bounds::Compared;
use crate::stability::case::{Instead, Windows, WordNetwork, Words};
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use edof_core::draw::Draw;
use edof_core::number::{InputWord, bits_of};
use edof_core::{Stride, Window};
use edof_golden::fast::Fast;
use edof_golden::{StageCounts, Trace};
use edof_network::FixedNetwork;
use edof_network::fixed_network::{FixedMatrix, layer_names};
use edof_network::network::{Form, Recurrence, Shrinkage};
use ndarray::ArrayView1;

/// Codes of random networks.
const CODES: usize = 24;
/// Windows of each kind.
const COUNT: usize = 192;
/// Steps of a climb.
const CLIMB: usize = 40;
/// Bits of an output word.
const OUTPUT_BITS: u32 = 16;

/// Runs one network on windows of one kind.
pub(crate) fn words(bench: &Bench, given: &Words) -> Result<TrialResult, Stopped> {
    let network = network(bench, &given.network)?;
    network.check()?;
    let compared = Compared::words(bench.subjects, network.clone())?;
    let windows = windows(&compared.fast, bench.subjects.words, given.windows);
    let traces = (bench.subjects.words)(&compared.fast, &windows);
    let mut checked = Checked::new(&network);
    traces.iter().for_each(|trace| checked.add(&network, trace));
    let name = match &given.network {
        WordNetwork::Trained(name) => name.as_str(),
        WordNetwork::Drawn { .. } => "drawn",
    };
    let found = compared.look(&windows);
    let mut seen = checked.seen(name, traces.len());
    seen.extend(compared.seen(name, &found, true));
    Ok(TrialResult { saturations: found.saturations, ..TrialResult::of(seen) })
}

/// Windows of one kind for a network.
pub(crate) fn windows(
    fast: &Fast,
    run: fn(&Fast, &[InputWord]) -> Vec<Trace>,
    kind: Windows,
) -> Vec<InputWord> {
    match kind {
        Windows::Extreme => extreme(fast.network()),
        Windows::BySignsOfRows => by_signs(fast.network()),
        Windows::Climbing => climbing(fast.network(), |windows| run(fast, windows)),
    }
}

fn network(bench: &Bench, which: &WordNetwork) -> Result<FixedNetwork, Stopped> {
    match which {
        WordNetwork::Trained(name) => {
            let found = bench.networks.iter().find(|trained| trained.name == *name);
            found
                .map(|trained| trained.fixed.clone())
                .ok_or_else(|| Stopped::Refused(format!("network '{name}': none of the trained ones")))
        }
        WordNetwork::Drawn { window, layers, bits, flags, tight, with } => {
            let form = Form {
                window: Window::new(*window)?,
                codes: CODES,
                layers: *layers,
                shrinkage: if flags[0] { Shrinkage::OneSided } else { Shrinkage::TwoSided },
                recurrence: if flags[1] { Recurrence::Difference } else { Recurrence::Direct },
                linear_path: flags[2],
                tied: flags[3],
                exposures: 1,
            };
            let mut network = edof_device::random::extreme(form, *bits, Stride::PATCH, *tight, 1);
            with.iter().for_each(|instead| put(&mut network, *instead));
            Ok(network)
        }
    }
}

fn put(network: &mut FixedNetwork, instead: Instead) {
    let max = ((1i32 << (network.code_bits - 1)) - 1) as i16;
    let weights = |network: &mut FixedNetwork, each: &dyn Fn(usize) -> i16| {
        let first = [&mut network.analysis, &mut network.dictionary].into_iter();
        for matrix in first.chain(&mut network.recurrent).chain(&mut network.linear_path) {
            matrix.weights.iter_mut().enumerate().for_each(|(i, w)| *w = each(i));
        }
    };
    let thresholds = |network: &mut FixedNetwork, word: i16| {
        network.thresholds.iter_mut().for_each(|theta| theta.fill(word));
    };
    match instead {
        // Runs of seven, so that rows differ.
        Instead::WeightsAtBothEnds => weights(network, &|i| if i / 7 % 2 == 0 { max } else { -max - 1 }),
        Instead::LargestWeights => weights(network, &|_| max),
        Instead::NoWeights => weights(network, &|_| 0),
        Instead::ThresholdsZero => thresholds(network, 0),
        Instead::ThresholdsHuge => thresholds(network, max),
        Instead::ThresholdsLeast => thresholds(network, -max - 1),
        Instead::LongestShifts => {
            // 15 + 47 − 15 is the longest shift of I; sums of M and F get theirs from the codes' 15 bits as well.
            network.code_fractions.fill(15);
            network.analysis.fraction = 47;
            weights(network, &|i| (i % 3) as i16 - 1);
            network.recurrent.iter_mut().for_each(|s| s.fraction = 31);
            network.dictionary.fraction = 30;
            network.linear_path.iter_mut().for_each(|r| r.fraction = 30);
        }
    }
}

fn extreme(network: &FixedNetwork) -> Vec<InputWord> {
    let draw = &mut Draw::new(5);
    let pixels = network.form.window.pixels();
    (0..COUNT).flat_map(|_| edof_device::random::extreme_window(draw, pixels)).collect()
}

/// For rows of A and of R: light wherever a weight is positive, and wherever it is negative.
fn by_signs(network: &FixedNetwork) -> Vec<InputWord> {
    let matrices = std::iter::once(&network.analysis).chain(&network.linear_path);
    let both = |row: ArrayView1<'_, i16>| {
        let light = |sign: i32| {
            row.iter()
                .map(|w| if i32::from(*w) * sign > 0 { InputWord::MAX } else { InputWord::ZERO })
                .collect::<Vec<_>>()
        };
        [light(1), light(-1)].concat()
    };
    matrices
        .flat_map(|matrix| matrix.weights.outer_iter().take(COUNT / 2).flat_map(both).collect::<Vec<_>>())
        .collect()
}

/// From windows by signs, words put to the ends one at a time as long as the sums of the last stages grow; all windows in flight.
fn climbing(network: &FixedNetwork, run: impl Fn(&[InputWord]) -> Vec<Trace>) -> Vec<InputWord> {
    let pixels = network.form.window.pixels();
    let draw = &mut Draw::new(7);
    let starts = by_signs(network);
    let mut all = vec![];
    for start in starts.chunks_exact(pixels).take(6) {
        let (mut best, mut max) = (start.to_vec(), -1.0);
        for _ in 0..CLIMB {
            let mut tries = best.clone();
            for _ in 0..7 {
                let mut window = best.clone();
                for _ in 0..draw.whole(1, 6) {
                    let at = draw.whole(0, pixels as i64 - 1) as usize;
                    window[at] = if window[at] == 0 { InputWord::MAX } else { InputWord::ZERO };
                }
                tries.extend(window);
            }
            for (window, trace) in tries.chunks_exact(pixels).zip(run(&tries)) {
                let size = largest_sums(network, &trace)[1..].iter().map(|size| (*size as f64).ln_1p()).sum();
                if size > max {
                    (best, max) = (window.to_vec(), size);
                }
            }
            all.extend(&best);
        }
    }
    all
}

/// Every sum of every stage: row by row, as wide as it comes.
fn sums(network: &FixedNetwork, trace: &Trace) -> Vec<Vec<i128>> {
    let product = |matrix: &FixedMatrix, row: usize, v: &[i16]| -> i128 {
        matrix.weights.row(row).iter().zip(v).map(|(w, v)| i128::from(*w) * i128::from(*v)).sum()
    };
    let codes = network.form.codes;
    let mut all = vec![
        (0..codes).map(|row| product(&network.analysis, row, bits_of(&trace.input))).collect::<Vec<_>>(),
    ];
    for t in 0..network.form.middle_layers() {
        let base = match network.form.recurrence {
            Recurrence::Direct => &trace.layers[0].b,
            Recurrence::Difference => &trace.layers[t].b,
        };
        let shift = network.middle_shifts(t).base;
        let sum = |row: usize| {
            (i128::from(base[row]) << shift)
                + product(network.recurrent_matrix(t), row, &trace.layers[t].sent)
        };
        all.push((0..codes).map(sum).collect());
    }
    let shifts = network.final_shifts();
    let last = &trace.layers[network.form.shrinkages() - 1].sent;
    let output = |row: usize| {
        let linear = network.linear_path.as_ref().map_or(0, |r| product(r, row, bits_of(&trace.input)));
        (product(&network.dictionary, row, last) << shifts.dictionary) + (linear << shifts.linear_path)
    };
    all.push((0..network.dictionary.weights.nrows()).map(output).collect());
    all
}

fn largest_sums(network: &FixedNetwork, trace: &Trace) -> Vec<u128> {
    sums(network, trace)
        .iter()
        .map(|stage| stage.iter().map(|v| v.unsigned_abs()).max().unwrap_or(0))
        .collect()
}

/// Rounds to nearest, ties up, then clamps to a width; returns whether it clamped.
fn rounded(sum: i128, shift: u32, bits: u32) -> (i128, bool) {
    let half = if shift == 0 { 0 } else { 1i128 << (shift - 1) };
    held((sum + half).div_euclid(1i128 << shift), bits)
}

fn held(value: i128, bits: u32) -> (i128, bool) {
    let full = 1i128 << (bits - 1);
    let held = value.clamp(-full, full - 1);
    (held, held != value)
}

/// What was found over all windows.
struct Checked {
    /// Largest sum of each stage.
    largest: Vec<u128>,
    wrong_words: u64,
    wrong_counts: u64,
    saturations: u64,
    bits: Vec<u32>,
    names: Vec<String>,
}

impl Checked {
    fn new(network: &FixedNetwork) -> Self {
        let layers = network.form.layers;
        let named = |(i, name): (usize, &str)| if name == "M" { format!("M{i}") } else { name.to_owned() };
        Self {
            largest: vec![0; layers],
            wrong_words: 0,
            wrong_counts: 0,
            saturations: 0,
            bits: network.accumulator_bits(),
            names: layer_names(layers).enumerate().map(named).collect(),
        }
    }

    fn add(&mut self, network: &FixedNetwork, trace: &Trace) {
        let sums = sums(network, trace);
        for (t, sums) in sums.iter().enumerate() {
            let mut counts = StageCounts::default();
            let largest = sums.iter().map(|v| v.unsigned_abs()).max().unwrap_or(0);
            self.largest[t] = self.largest[t].max(largest);
            let (shift, bits) = match t {
                0 => (network.analysis_shift(), network.code_bits),
                _ if t < network.form.shrinkages() => {
                    (network.middle_shifts(t - 1).result, network.code_bits)
                }
                _ => (network.final_shifts().result, OUTPUT_BITS),
            };
            let words = trace.layers.get(t).map_or(bits_of(&trace.output), |layer| &layer.b);
            for (sum, word) in sums.iter().zip(words) {
                let (right, saturated) = rounded(*sum, shift, bits);
                self.wrong_words += u64::from(right != i128::from(*word));
                counts.saturated_results += u64::from(saturated);
            }
            if let Some(layer) = trace.layers.get(t) {
                self.shrinkage(network, trace, t, &mut counts);
                counts.nonzeros = layer.sent.iter().filter(|v| **v != 0).count() as u64;
            }
            self.wrong_counts += u64::from(trace.stages[t] != counts);
            self.saturations += counts.saturations();
        }
    }

    /// z from b and what is sent from z.
    fn shrinkage(&mut self, network: &FixedNetwork, trace: &Trace, t: usize, counts: &mut StageCounts) {
        let (layer, bits) = (&trace.layers[t], network.code_bits);
        let differs = edof_golden::scalar::sends_difference(network, t);
        for (i, theta) in network.thresholds[t].iter().enumerate() {
            let (b, theta) = (i128::from(layer.b[i]), i128::from(*theta));
            let shrunk = match network.form.shrinkage {
                Shrinkage::OneSided => (b - theta).max(0),
                Shrinkage::TwoSided => (b - theta).max(0) + (b + theta).min(0),
                Shrinkage::Firm if b.abs() >= 2 * theta => b,
                Shrinkage::Firm => 2 * ((b - theta).max(0) + (b + theta).min(0)),
            };
            let (z, saturated) = held(shrunk, bits);
            counts.saturated_codes += u64::from(saturated);
            self.wrong_words += u64::from(z != i128::from(layer.z[i]));
            let before = if differs && t > 0 { i128::from(trace.layers[t - 1].z[i]) } else { 0 };
            let (sent, saturated) = held(z - before, bits);
            counts.saturated_differences += u64::from(saturated);
            self.wrong_words += u64::from(sent != i128::from(layer.sent[i]));
        }
    }

    fn seen(&self, name: &str, windows: usize) -> Vec<Measurement> {
        let mut seen = vec![
            Measurement::fact(name, "every word is that of sums in 128 bits", self.wrong_words == 0)
                .noted(format!("{windows} windows, {} words differ", self.wrong_words)),
            Measurement::fact(name, "every saturation is counted", self.wrong_counts == 0).noted(format!(
                "{} saturations, {} stages count otherwise",
                self.saturations, self.wrong_counts
            )),
        ];
        for ((stage, largest), bits) in self.names.iter().zip(&self.largest).zip(&self.bits) {
            let limit = 1u128 << (bits - 1);
            let what = format!("largest sum of {stage}, of its accumulator");
            let share = *largest as f64 / limit as f64;
            seen.push(Measurement::new(name, what, share, 1.0).noted(format!("{largest} in {bits} bits")));
        }
        seen
    }
}
