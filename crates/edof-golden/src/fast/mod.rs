//! The same words as [`crate::scalar`], faster: patches in batches, weights packed for SIMD, zero sparse codes skipped.
//!
//! | what | module |
//! |---|---|
//! | weights packed for a kernel, and what bounds their sums | [`pack`] |
//! | which non-zero sparse codes multiply which columns | [`pairs`] |
//! | instruction sets, and tokens for those that were detected | [`isa`] |
//! | kernels in plain Rust | [`portable`] |
//! | kernels for AVX2 and AVX-512 | `x86` |
//! | accumulators to words: round, shift, saturate, shrink | [`finish`] |
//!
//! Sums run in 32 bits as long as a bound proves that they fit, and are then added to 64-bit accumulators. For dense products
//! the bound is a block's largest row sum of |weights| times the batch's largest input; for sparse ones it is each column's
//! largest |weight| times its sparse code, summed as they come. Both hold for every partial sum.

pub mod finish;
pub mod isa;
pub mod pack;
pub mod pairs;
pub mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::scalar::sends_difference;
use crate::trace::{LayerWords, StageCounts, Trace};
use edof_spec::FixedNetwork;
use edof_spec::colour::OUTPUTS_422;
use edof_spec::network::Recurrence;
use finish::{Finish, Threshold};
use isa::Isa;
use pack::{Dense, Sparse};
use pairs::Pairs;

/// A network packed for one instruction set.
#[derive(Debug, Clone)]
pub struct Fast {
    network: FixedNetwork,
    isa: Isa,
    analysis: Dense,
    recurrent: Vec<Sparse>,
    dictionary: Sparse,
    linear_path: Option<Dense>,
}

/// Room for the words of [`Batch::PATCHES`] patches at every stage boundary.
#[derive(Debug, Clone)]
pub struct Batch {
    input: Vec<i16>,
    pixels: usize,
    words: Vec<LayerWords>,
    length: usize,
    output: Vec<i16>,
    stages: Vec<StageCounts>,
    layers: usize,
    accumulators: Vec<i64>,
    linear: Vec<i64>,
    pairs: Pairs,
}

impl Batch {
    /// Patches in a batch.
    pub const PATCHES: usize = 48;

    /// Room for batches of this network.
    #[must_use]
    pub fn new(fast: &Fast) -> Self {
        let form = fast.network.form;
        let words = || vec![0; Self::PATCHES * form.codes];
        Self {
            input: vec![0; Self::PATCHES * form.window.pixels()],
            pixels: form.window.pixels(),
            words: (0..form.shrinkages())
                .map(|_| LayerWords { b: words(), z: words(), sent: words() })
                .collect(),
            length: form.codes,
            output: vec![0; Self::PATCHES * OUTPUTS_422],
            stages: vec![StageCounts::default(); Self::PATCHES * form.layers],
            layers: form.layers,
            accumulators: vec![0; Self::PATCHES * pack::padded(form.codes.max(OUTPUTS_422))],
            linear: vec![0; Self::PATCHES * pack::padded(OUTPUTS_422)],
            pairs: Pairs::default(),
        }
    }

    /// F's words of patch `i`.
    #[must_use]
    pub fn output(&self, i: usize) -> &[i16] {
        &self.output[i * OUTPUTS_422..][..OUTPUTS_422]
    }

    /// Counters of patch `i`: I, each M, F.
    #[must_use]
    pub fn stages(&self, i: usize) -> &[StageCounts] {
        &self.stages[i * self.layers..][..self.layers]
    }

    /// Every boundary of patch `i`, as the specification gives it.
    #[must_use]
    pub fn trace(&self, i: usize) -> Trace {
        let part = |words: &[i16]| words[i * self.length..][..self.length].to_vec();
        Trace {
            input: self.input[i * self.pixels..][..self.pixels].to_vec(),
            layers: self
                .words
                .iter()
                .map(|c| LayerWords { b: part(&c.b), z: part(&c.z), sent: part(&c.sent) })
                .collect(),
            output: self.output(i).to_vec(),
            stages: self.stages(i).to_vec(),
        }
    }
}

impl Fast {
    /// Packs a checked network for the fastest kernels of this machine.
    #[must_use]
    pub fn new(network: FixedNetwork) -> Self {
        Self::with_isa(network, Isa::best())
    }

    /// Packs a checked network for given kernels.
    #[must_use]
    pub fn with_isa(network: FixedNetwork, isa: Isa) -> Self {
        Self {
            isa,
            analysis: Dense::new(&network.analysis.weights),
            recurrent: network.recurrent.iter().map(|s| Sparse::new(&s.weights, isa)).collect(),
            dictionary: Sparse::new(&network.dictionary.weights, isa),
            linear_path: network.linear_path.as_ref().map(|r| Dense::new(&r.weights)),
            network,
        }
    }

    /// The network.
    #[must_use]
    pub const fn network(&self) -> &FixedNetwork {
        &self.network
    }

    /// Every boundary of each window: `windows` holds `window.pixels()` input words (0…32767) a window, one after the other.
    #[must_use]
    pub fn traces(&self, windows: &[i16]) -> Vec<Trace> {
        let mut batch = Batch::new(self);
        let pixels = self.network.form.window.pixels();
        let mut traces = Vec::with_capacity(windows.len() / pixels);
        for some in windows.chunks(pixels * Batch::PATCHES) {
            let count = some.len() / pixels;
            self.run(&mut batch, count, |i, words| words.copy_from_slice(&some[i * pixels..][..pixels]));
            traces.extend((0..count).map(|i| batch.trace(i)));
        }
        traces
    }

    /// Runs `count` patches (at most [`Batch::PATCHES`]); `fill(i, words)` writes the input words (0…32767) of the i-th.
    pub fn run(&self, batch: &mut Batch, count: usize, mut fill: impl FnMut(usize, &mut [i16])) {
        let count = count.min(Batch::PATCHES);
        let pixels = batch.pixels;
        batch.input.chunks_exact_mut(pixels).take(count).enumerate().for_each(|(i, words)| fill(i, words));
        batch.stages.fill(StageCounts::default());
        let input = &batch.input[..count * pixels];
        self.dense(&self.analysis, input, &mut batch.accumulators);
        for t in 0..self.network.form.shrinkages() {
            self.layer(batch, t, count);
        }
        if let Some(r) = &self.linear_path {
            self.dense(r, &batch.input[..count * pixels], &mut batch.linear);
        }
        self.outputs(batch, count);
    }

    /// Stage t (0 = I): b, z and what it sends, for `count` patches.
    fn layer(&self, batch: &mut Batch, t: usize, count: usize) {
        let n = batch.length;
        let stride = pack::padded(n);
        let (before, rest) = batch.words.split_at_mut(t);
        let before = &*before;
        let LayerWords { b, z, sent } = &mut rest[0];
        let bits = self.network.code_bits;
        let threshold = Threshold {
            shrinkage: self.network.form.shrinkage,
            theta: self.network.thresholds[t].as_slice().unwrap_or_default(),
            bits,
        };
        let (finish, matrix) = if t == 0 {
            (Finish { base_shift: 0, shift: self.network.analysis_shift(), bits }, None)
        } else {
            let shifts = self.network.middle_shifts(t - 1);
            let matrix = &self.recurrent[self.network.form.recurrent_index(t - 1)];
            (Finish { base_shift: shifts.base, shift: shifts.result, bits }, Some(matrix))
        };
        let sends_difference = sends_difference(&self.network, t);
        for i in 0..count {
            let (at, counts) = (i * n..(i + 1) * n, &mut batch.stages[i * batch.layers + t]);
            let base = match (self.network.form.recurrence, before) {
                (_, []) => None,
                (Recurrence::Direct, [first, ..]) => Some(&first.b[at.clone()]),
                (Recurrence::Difference, [.., last]) => Some(&last.b[at.clone()]),
            };
            let sums = match (matrix, before) {
                (Some(matrix), [.., last]) => {
                    let sums = &mut batch.accumulators[..stride];
                    batch.pairs.collect(self.isa, &last.sent[at.clone()], &matrix.bounds);
                    self.sparse(matrix, &batch.pairs, sums);
                    &*sums
                }
                _ => &batch.accumulators[i * stride..(i + 1) * stride],
            };
            let b = &mut b[at.clone()];
            counts.saturated_results = finish::words(self.isa, finish, &sums[..n], base, b);
            let z = &mut z[at.clone()];
            counts.saturated_codes = finish::shrink(self.isa, threshold, b, z);
            let sent = &mut sent[at.clone()];
            let previous = before.last().map(|last| &last.z[at]);
            match (sends_difference, previous) {
                (true, Some(previous)) => {
                    counts.saturated_differences = finish::difference(self.isa, bits, z, previous, sent);
                }
                _ => sent.copy_from_slice(z),
            }
            counts.nonzeros = finish::nonzeros(self.isa, sent);
        }
    }

    /// F's words of `count` patches.
    fn outputs(&self, batch: &mut Batch, count: usize) {
        let (n, stride) = (batch.length, pack::padded(OUTPUTS_422));
        let shifts = self.network.final_shifts();
        let Some(last) = batch.words.last() else { return };
        for i in 0..count {
            let sums = &mut batch.accumulators[..stride];
            batch.pairs.collect(self.isa, &last.sent[i * n..(i + 1) * n], &self.dictionary.bounds);
            self.sparse(&self.dictionary, &batch.pairs, sums);
            let linear = self.linear_path.is_some().then(|| &batch.linear[i * stride..][..OUTPUTS_422]);
            let output = &mut batch.output[i * OUTPUTS_422..][..OUTPUTS_422];
            let saturated = finish::outputs(self.isa, shifts, &sums[..OUTPUTS_422], linear, output);
            batch.stages[(i + 1) * batch.layers - 1].saturated_results = saturated;
        }
    }

    /// Dense products of patches that lie one after the other, into rows of [`pack::padded`] accumulators each.
    fn dense(&self, matrix: &Dense, input: &[i16], sums: &mut [i64]) {
        // The packed kernels' bound holds for inputs of 0 or more, which is what windows hold.
        let isa = if input.iter().any(|v| *v < 0) { Isa::Portable } else { self.isa };
        match isa {
            Isa::Portable => portable::dense(matrix, input, sums),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => x86::avx2::dense(token, matrix, input, sums),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => x86::avx512::dense(token, matrix, input, sums),
            #[cfg(not(target_arch = "x86_64"))]
            _ => portable::dense(matrix, input, sums),
        }
    }

    /// The product of one sparse vector into [`pack::padded`] accumulators.
    fn sparse(&self, matrix: &Sparse, pairs: &Pairs, sums: &mut [i64]) {
        match self.isa {
            Isa::Portable => portable::sparse(matrix, pairs, sums),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => x86::avx2::sparse(token, matrix, pairs, sums),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => x86::avx512::sparse(token, matrix, pairs, sums),
            #[cfg(not(target_arch = "x86_64"))]
            _ => portable::sparse(matrix, pairs, sums),
        }
    }
}
