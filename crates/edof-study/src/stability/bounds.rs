//! Integers and `f32` against `f64`, window by window, with the bounds that were computed before: on random windows, and on windows that climb
//! towards the bound.
//!
//! A climb starts from a random window and a result of one stage, and changes some input words at a time as long as that result comes
//! further off; what is far off is a rounding of every sum in the same direction, so it is found by trying, not by following a slope.

use crate::stability::bench::{Bench, Trained};
use crate::stability::outcome::{Measurement, StageMeasurement, Stopped, TrialResult};
use crate::stability::subjects::Subjects;
use edof_core::draw::Draw;
use edof_core::number::{InputWord, bits_of};
use edof_golden::fast::Fast;
use edof_golden::{StageCounts, Trace};
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedNetworkError;
use edof_quantize::bounds::{Arithmetic, StageBound, reference};
use edof_quantize::float_reference::{FloatReference, Values};
use edof_quantize::fold::Folded;
use rayon::prelude::*;

/// Windows that go through everything at once.
const BATCH: usize = 192;
/// Windows that a climb compares at a time, the best so far among them.
const CLIMBERS: usize = 24;
/// `f64` is itself rounded: this much of a bound, and of a last bit, is not held against anybody.
const SLACK: f64 = 1e-9;

/// One network with everything that it is compared with.
pub(crate) struct Compared {
    pub(crate) fast: Fast,
    subjects: Subjects,
    /// The float network, and the words taken for real numbers.
    against: Vec<Against>,
    single: Option<(FloatReference<f32>, Vec<StageBound>)>,
}

struct Against {
    /// What it is called.
    what: &'static str,
    twin: FloatReference<f64>,
    bounds: Vec<StageBound>,
}

/// The words taken for real numbers.
const WITHOUT_ROUNDING: &str = "words without rounding";

/// How far off windows were at one stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Off {
    /// Largest share of its bound that a result used.
    share: f64,
    /// The same result's distance, in LSB.
    bits: f64,
    /// Bound of the error in LSB.
    bound: f64,
    /// Largest distance in LSB of any result.
    max_bits: f64,
    /// Results beyond their bounds.
    violations: u64,
}

impl Off {
    fn merged(self, other: Self) -> Self {
        let worse = if other.share > self.share { other } else { self };
        Self {
            max_bits: self.max_bits.max(other.max_bits),
            violations: self.violations + other.violations,
            ..worse
        }
    }

    fn add(&mut self, off: f64, worst: f64, unit: f64) {
        let slack = SLACK * (worst + unit);
        let share = if worst > 0.0 { off / worst } else { 0.0 };
        let beyond = off.is_nan() || off > worst + slack;
        if share > self.share || (beyond && self.violations == 0) {
            (self.share, self.bits, self.bound) = (share, off / unit, worst / unit);
        }
        self.max_bits = self.max_bits.max(off / unit);
        self.violations += u64::from(beyond);
    }
}

/// All stages, against everything that a network is compared with.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Found {
    pub(crate) windows: u64,
    /// Values of the float network itself that reached an end of their range.
    clipped: u64,
    pub(crate) saturations: u64,
    /// For each of [`Compared::against`], then `f32`: stage by stage.
    off: Vec<Vec<Off>>,
}

impl Found {
    pub(crate) fn merged(mut self, other: Self) -> Self {
        if self.windows == 0 {
            return other;
        }
        self.windows += other.windows;
        self.clipped += other.clipped;
        self.saturations += other.saturations;
        for (own, other) in self.off.iter_mut().zip(other.off) {
            own.iter_mut().zip(other).for_each(|(own, other)| *own = own.merged(other));
        }
        self
    }
}

impl Compared {
    /// A trained network, against its float one.
    pub(crate) fn trained(subjects: Subjects, trained: &Trained) -> Result<Self, FixedNetworkError> {
        let mut all = Self::words(subjects, trained.fixed.clone())?;
        if let Some(real) = reference(&trained.fixed, &trained.float) {
            let bounds = edof_quantize::bounds::bounds(&trained.fixed, &real, Arithmetic::Words);
            let single = edof_quantize::bounds::bounds(&trained.fixed, &real, Arithmetic::Single);
            let twin = FloatReference::new(&trained.fixed, &real);
            all.against.insert(0, Against { what: "float network", twin, bounds });
            all.single = Some((FloatReference::new(&trained.fixed, &real), single));
        }
        Ok(all)
    }

    /// A network of words alone.
    pub(crate) fn words(subjects: Subjects, fixed: FixedNetwork) -> Result<Self, FixedNetworkError> {
        fixed.check()?;
        let own = Folded::of(&fixed);
        let bounds = edof_quantize::bounds::bounds(&fixed, &own, Arithmetic::Words);
        let twin = FloatReference::new(&fixed, &own);
        let single = edof_quantize::bounds::bounds(&fixed, &own, Arithmetic::Single);
        let single = Some((FloatReference::new(&fixed, &own), single));
        let against = vec![Against { what: WITHOUT_ROUNDING, twin, bounds }];
        Ok(Self { fast: Fast::new(fixed), subjects, against, single })
    }

    fn fixed(&self) -> &FixedNetwork {
        self.fast.network()
    }

    fn pixels(&self) -> usize {
        self.fixed().form.window.pixels()
    }

    /// Compares windows of input words, on all threads.
    pub(crate) fn look(&self, windows: &[InputWord]) -> Found {
        windows
            .par_chunks(BATCH * self.pixels())
            .map(|some| self.batch(some))
            .reduce(Found::default, Found::merged)
    }

    fn batch(&self, windows: &[InputWord]) -> Found {
        let (traces, reals) = self.evaluated(windows);
        self.found(windows, &traces, &reals)
    }

    fn evaluated(&self, windows: &[InputWord]) -> (Vec<Trace>, Vec<Values<f64>>) {
        let traces = (self.subjects.words)(&self.fast, windows);
        (traces, self.against.iter().map(|against| against.twin.run(windows)).collect())
    }

    fn found(&self, windows: &[InputWord], traces: &[Trace], reals: &[Values<f64>]) -> Found {
        let mut found = Found {
            windows: traces.len() as u64,
            clipped: reals.first().map_or(0, |values| values.clipped),
            saturations: traces.iter().flat_map(|trace| &trace.stages).map(StageCounts::saturations).sum(),
            off: vec![],
        };
        for (against, real) in self.against.iter().zip(reals) {
            found.off.push(words_off(traces, real, &against.bounds));
        }
        if let (Some((twin, bounds)), Some(real)) = (&self.single, reals.first()) {
            found.off.push(single_off(&twin.run(windows), real, bounds));
        }
        found
    }

    /// Windows that take one result of one stage as far off as changes of some words at a time can.
    fn climb(&self, seed: u64, evaluations: usize) -> Found {
        let (draw, pixels) = (&mut Draw::new(seed), self.pixels());
        let stages = self.fixed().form.layers;
        let stage = draw.whole(0, stages as i64 - 1) as usize;
        let against = draw.whole(0, self.against.len() as i64 - 1) as usize;
        let rows = self.against[against].bounds[stage].worst.len();
        let row = draw.whole(0, rows as i64 - 1) as usize;
        let mut best = self.start(draw, stage, row);
        let mut far = f64::NEG_INFINITY;
        let mut found = Found::default();
        for round in 0..evaluations / CLIMBERS {
            let mut windows = Vec::with_capacity(CLIMBERS * pixels);
            windows.extend(&best);
            // Many words at first, single ones at the end.
            let max = (pixels >> (round / 4).min(30)).max(1) as i64;
            for _ in 1..CLIMBERS {
                let mut window = best.clone();
                for _ in 0..draw.whole(1, max) {
                    let at = draw.whole(0, pixels as i64 - 1) as usize;
                    let bits = match draw.whole(0, 3) {
                        0 => draw.extreme(16).max(0).into(),
                        1 => draw.whole(0, i64::from(i16::MAX)),
                        _ => i64::from(window[at].to_bits()) + draw.whole(-3, 3),
                    };
                    window[at] = InputWord::from_bits(bits.clamp(0, i64::from(i16::MAX)) as i16);
                }
                windows.extend(window);
            }
            let (traces, reals) = self.evaluated(&windows);
            for (i, distance) in self.distances(&traces, &reals, against, stage, row).into_iter().enumerate()
            {
                if distance > far {
                    far = distance;
                    best.copy_from_slice(&windows[i * pixels..][..pixels]);
                }
            }
            found = found.merged(self.found(&windows, &traces, &reals));
        }
        found
    }

    /// Where a climb begins: a random window, or one by the signs of a row of A or R, to the largest or the least sum.
    fn start(&self, draw: &mut Draw, stage: usize, row: usize) -> Vec<InputWord> {
        let network = self.fixed();
        let matrix = match &network.linear_path {
            Some(r) if stage + 1 == network.form.layers => &r.weights,
            _ => &network.analysis.weights,
        };
        let sign = match draw.whole(0, 2) {
            0 => 1,
            1 => -1,
            _ => return edof_device::random::extreme_window(draw, self.pixels()),
        };
        let light = |w: &i16| if i32::from(*w) * sign > 0 { InputWord::MAX } else { InputWord::ZERO };
        matrix.row(row % matrix.nrows()).iter().map(light).collect()
    }

    /// How far off a row of a stage is, for each window.
    fn distances(
        &self,
        traces: &[Trace],
        reals: &[Values<f64>],
        against: usize,
        stage: usize,
        row: usize,
    ) -> Vec<f64> {
        let (values, unit) = (&reals[against].stages[stage], self.against[against].bounds[stage].unit);
        let width = values.len() / traces.len().max(1);
        let each = traces.iter().zip(values.chunks_exact(width));
        each.map(|(trace, values)| (f64::from(stage_words(trace, stage)[row]) * unit - values[row]).abs())
            .collect()
    }

    /// What was found, as measurements of a case.
    pub(crate) fn seen(&self, name: &str, found: &Found, only_last: bool) -> Vec<Measurement> {
        let mut seen = vec![];
        let kinds =
            self.against.iter().map(|against| (format!("{name}.fixed"), against.what, &against.bounds));
        let single = self.single.iter().map(|(_, bounds)| (format!("{name}.f32"), "f64", bounds));
        for ((subject, what, bounds), off) in kinds.chain(single).zip(&found.off) {
            for (index, (bound, off)) in bounds.iter().zip(off).enumerate() {
                if only_last && index + 1 < bounds.len() {
                    continue;
                }
                let summary = bound.summary();
                let tail = (2.0 * (2.0 * found.windows as f64 * bound.worst.len() as f64).ln()).sqrt();
                // Against the float network weights are rounded, too, which no deviation here is of.
                let own = what == WITHOUT_ROUNDING && summary.deviation_bits > 0.0;
                let deviation = own.then_some(summary.deviation_bits);
                let stage = StageMeasurement {
                    stage: bound.name.clone(),
                    against: what,
                    bound: off.bound,
                    seen: off.bits,
                    largest_bound: summary.worst_bits,
                    furthest: off.max_bits,
                    statistical: deviation.map(|bits| tail * bits),
                    violations: off.violations,
                    windows: found.windows,
                };
                let note =
                    format!("{:.3} of {:.3} last bits, {} violations", off.bits, off.bound, off.violations);
                let what = format!("{} off the {what}, of its bound", bound.name);
                let mut one = Measurement::new(&subject, what, off.share, 1.0 + SLACK).noted(note);
                (one.held, one.stage) = (off.violations == 0, Some(stage));
                seen.push(one);
            }
        }
        seen
    }
}

fn stage_words(trace: &Trace, stage: usize) -> &[i16] {
    trace.layers.get(stage).map_or(bits_of(&trace.output), |layer| &layer.b)
}

fn words_off(traces: &[Trace], real: &Values<f64>, bounds: &[StageBound]) -> Vec<Off> {
    let stage = |(stage, (bound, values)): (usize, (&StageBound, &Vec<f64>))| {
        let mut off = Off::default();
        for (trace, values) in traces.iter().zip(values.chunks_exact(bound.worst.len())) {
            let words = stage_words(trace, stage);
            for ((word, value), worst) in words.iter().zip(values).zip(&bound.worst) {
                off.add((f64::from(*word) * bound.unit - value).abs(), *worst, bound.unit);
            }
        }
        off
    };
    bounds.iter().zip(&real.stages).enumerate().map(stage).collect()
}

fn single_off(single: &Values<f32>, real: &Values<f64>, bounds: &[StageBound]) -> Vec<Off> {
    let stage = |(bound, (single, real)): (&StageBound, (&Vec<f32>, &Vec<f64>))| {
        let mut off = Off::default();
        for ((a, b), worst) in single.iter().zip(real).zip(bound.worst.iter().cycle()) {
            off.add((f64::from(*a) - b).abs(), *worst, bound.unit);
        }
        off
    };
    bounds.iter().zip(single.stages.iter().zip(&real.stages)).map(stage).collect()
}

/// Evaluations of one climb.
const CLIMB: usize = 2400;

/// A network on random windows and on as many of climbs.
pub(crate) fn bounds(bench: &Bench, network: &str) -> Result<TrialResult, Stopped> {
    let compared = match bench.networks.iter().find(|trained| trained.name == network) {
        Some(trained) => Compared::trained(bench.subjects, trained)?,
        None => Compared::words(bench.subjects, drawn(network)?)?,
    };
    let (pixels, windows) = (compared.pixels(), bench.windows);
    let random = (0..windows.div_ceil(BATCH))
        .into_par_iter()
        .map(|batch| {
            let draw = &mut Draw::new(batch as u64);
            let count = BATCH.min(windows - batch * BATCH);
            let windows: Vec<InputWord> = (0..count).flat_map(|i| window(draw, pixels, i)).collect();
            compared.batch(&windows)
        })
        .reduce(Found::default, Found::merged);
    let climbs = (0..(windows / CLIMB).max(4))
        .into_par_iter()
        .map(|seed| compared.climb(seed as u64, CLIMB.min(windows)))
        .reduce(Found::default, Found::merged);
    let saturations = random.saturations + climbs.saturations;
    let found = random.merged(climbs);
    let mut seen = compared.seen(network, &found, false);
    if let Some(first) = seen.first_mut() {
        let held = format!("{} values of the float network itself held to the end of a range", found.clipped);
        first.note = format!("{}; {} windows, {held}", first.note, found.windows);
    }
    Ok(TrialResult { saturations, ..TrialResult::of(seen) })
}

/// Windows by turns: extreme words, smooth light with noise, any words.
fn window(draw: &mut Draw, pixels: usize, i: usize) -> Vec<InputWord> {
    match i % 3 {
        0 => edof_device::random::extreme_window(draw, pixels),
        1 => {
            let (level, slope) = (draw.whole(0, 30_000), draw.whole(-200, 200));
            let word =
                |at: usize, noise: i64| (level + slope * at as i64 / 4 + noise).clamp(0, i64::from(i16::MAX));
            (0..pixels).map(|at| InputWord::from_bits(word(at, draw.whole(-400, 400)) as i16)).collect()
        }
        _ => (0..pixels).map(|_| InputWord::from_bits(draw.whole(0, i64::from(i16::MAX)) as i16)).collect(),
    }
}

/// A random network with the statistics of a trained one: `drawn-WINDOW-STRIDE`.
fn drawn(name: &str) -> Result<FixedNetwork, Stopped> {
    let numbers: Option<Vec<usize>> = name
        .strip_prefix("drawn-")
        .map(|rest| rest.split('-').filter_map(|part| part.parse().ok()).collect());
    match numbers.as_deref() {
        Some([window, stride]) => Ok(edof_device::random::natural(*window, *stride, 1)),
        _ => Err(Stopped::Refused(format!(
            "network '{network}': none of the trained ones, and not drawn-WINDOW-STRIDE",
            network = name
        ))),
    }
}
