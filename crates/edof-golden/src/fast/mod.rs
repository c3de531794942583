//! The same words as [`crate::scalar`], faster: patches in batches, weights packed for SIMD, zero sparse codes skipped.
//!
//! | what | module |
//! |---|---|
//! | weights for dense vectors, and what bounds their sums | `pack` |
//! | weights for sparse vectors | `columns` |
//! | sums of 40 bits in two numbers of 32 | `sums` |
//! | which sparse codes are not zero | `active` |
//! | instruction sets, and tokens for those that were detected | `isa` |
//! | what kernels multiply by weights | `operands` |
//! | matrix products | `kernels` |
//! | in plain Rust | `portable` |
//! | for AVX2 and AVX-512 | `x86` |
//! | for AMX: products of whole vectors, sparse ones too | `amx` |
//! | sums to words: round, shift, saturate, shrink | `finish` |
//!
//! Sums run in 32 bits as long as a bound proves that they fit, and are then split into `sums::Sums`. For dense products the bound is a
//! block's largest row sum of weights of one sign times the largest input; for sparse ones it is the matrix's largest |weight| times
//! Σ |sparse code|. Both hold for every partial sum.

mod active;
mod amx;
mod columns;
mod finish;
pub(crate) mod isa;
mod kernels;
mod operands;
mod pack;
mod portable;
mod sums;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use isa::Isa;

use crate::scalar::{self, sends_difference};
use crate::trace::{LayerWords, StageCounts, Trace};
use active::Active;
use amx::{Planes, Tiled, Vectors};
use columns::Columns;
use edof_core::colour::OUTPUTS_422;
use edof_core::number::{InputWord, OutputWord, bits_of, words_of};
use edof_network::FixedNetwork;
use edof_network::network::Recurrence;
use finish::{Finish, FinishOutputs};
use isa::Amx;
use operands::Inputs;
use pack::{Packed, padded};
use sums::Sums;

/// A network packed for one instruction set.
#[derive(Debug, Clone)]
pub struct Fast {
    network: FixedNetwork,
    isa: Isa,
    analysis: Packed,
    stages: Vec<Stage>,
    recurrent: Vec<Columns>,
    dictionary: Columns,
    linear_path: Option<Packed>,
    tiled: Option<TiledNetwork>,
    finish: FinishOutputs,
}

/// The matrices for AMX.
#[derive(Debug, Clone)]
struct TiledNetwork {
    token: Amx,
    analysis: Tiled,
    /// What each stage's words are multiplied by ([`Fast::after`]).
    after: Vec<Tiled>,
    linear_path: Option<Tiled>,
}

impl TiledNetwork {
    fn new(network: &FixedNetwork, isa: Isa) -> Option<Self> {
        let Isa::Amx(token) = isa else { return None };
        let stages = network.form.shrinkages();
        let recurrent = (0..stages - 1).map(|t| &network.recurrent[network.form.recurrent_index(t)].weights);
        Some(Self {
            token,
            analysis: Tiled::new(&network.analysis.weights),
            after: recurrent.chain([&network.dictionary.weights]).map(Tiled::new).collect(),
            linear_path: network.linear_path.as_ref().map(|r| Tiled::new(&r.weights)),
        })
    }
}

/// What an I or M stage does with its sums.
#[derive(Debug, Clone)]
struct Stage {
    finish: Finish,
    /// θ of each pre-activation, zeros after the last.
    theta: Vec<i16>,
    sends_difference: bool,
}

/// Room for the words of [`Batch::PATCHES`] patches at every stage boundary.
#[derive(Debug, Clone)]
pub struct Batch {
    windows: Windows,
    /// Of each patch as many words as a matrix has padded rows; zeros after the last. What is sent only where it is not z.
    words: Vec<LayerWords>,
    codes: usize,
    output: Vec<i16>,
    stages: Vec<StageCounts>,
    layers: usize,
    sums: Sums,
    linear: Sums,
    active: Active,
    planes: Planes,
}

impl Batch {
    /// Patches in a batch: whole tiles of vectors, whose words fit the second cache beside the weights.
    pub const PATCHES: usize = 96;

    /// Room for batches of this network.
    #[must_use]
    pub fn new(fast: &Fast) -> Self {
        let form = fast.network.form;
        let rows = padded(form.codes);
        let codes = || vec![0; Self::PATCHES * rows];
        Self {
            windows: Windows::new(Self::PATCHES, form.window.pixels()),
            words: fast
                .stages
                .iter()
                .map(|stage| LayerWords {
                    b: codes(),
                    z: codes(),
                    sent: if stage.sends_difference { codes() } else { vec![] },
                })
                .collect(),
            codes: form.codes,
            output: vec![0; Self::PATCHES * OUTPUTS_422],
            stages: vec![StageCounts::default(); Self::PATCHES * form.layers],
            layers: form.layers,
            sums: Sums::new(Self::PATCHES * rows.max(OUTPUTS_422)),
            linear: Sums::new(Self::PATCHES * OUTPUTS_422),
            active: Active::default(),
            planes: Planes::default(),
        }
    }

    /// F's words of patch `i`.
    #[must_use]
    pub fn output(&self, i: usize) -> &[OutputWord] {
        words_of(&self.output[i * OUTPUTS_422..][..OUTPUTS_422])
    }

    /// Counters of patch `i`: I, each M, F.
    #[must_use]
    pub fn stages(&self, i: usize) -> &[StageCounts] {
        &self.stages[i * self.layers..][..self.layers]
    }

    /// Every boundary of patch `i`, as the specification gives it.
    #[must_use]
    pub fn trace(&self, i: usize) -> Trace {
        let part = |words: &[i16]| words[i * padded(self.codes)..][..self.codes].to_vec();
        Trace {
            input: self.windows.window(i).to_vec(),
            layers: self
                .words
                .iter()
                .map(|c| LayerWords { b: part(&c.b), z: part(&c.z), sent: part(sent(c)) })
                .collect(),
            output: self.output(i).to_vec(),
            stages: self.stages(i).to_vec(),
        }
    }

    /// Keeps what the specification gives of patch `i`.
    fn set(&mut self, i: usize, trace: &Trace) {
        let at = i * padded(self.codes)..i * padded(self.codes) + self.codes;
        for (all, one) in self.words.iter_mut().zip(&trace.layers) {
            all.b[at.clone()].copy_from_slice(&one.b);
            all.z[at.clone()].copy_from_slice(&one.z);
            if let Some(sent) = all.sent.get_mut(at.clone()) {
                sent.copy_from_slice(&one.sent);
            }
        }
        self.output[i * OUTPUTS_422..][..OUTPUTS_422].copy_from_slice(bits_of(&trace.output));
        self.stages[i * self.layers..][..self.layers].copy_from_slice(&trace.stages);
    }
}

/// Input words of some windows.
#[derive(Debug, Clone)]
struct Windows {
    words: Vec<InputWord>,
    /// Of each window ([`Inputs::largest`]).
    largest: Vec<i16>,
    pixels: usize,
}

impl Windows {
    fn new(windows: usize, pixels: usize) -> Self {
        Self { words: vec![InputWord::ZERO; windows * pixels], largest: vec![0; windows], pixels }
    }

    fn fill(&mut self, count: usize, mut fill_one: impl FnMut(usize, &mut [InputWord])) {
        let windows = self.words.chunks_exact_mut(self.pixels);
        windows.take(count).enumerate().for_each(|(i, words)| fill_one(i, words));
    }

    /// Finds the largest words, which bound sums; tiles need no bound.
    fn bound(&mut self, isa: Isa, count: usize) {
        let windows = self.words.chunks_exact(self.pixels).zip(&mut self.largest);
        windows.take(count).for_each(|(words, largest)| *largest = kernels::largest(isa, bits_of(words)));
    }

    fn window(&self, i: usize) -> &[InputWord] {
        &self.words[i * self.pixels..][..self.pixels]
    }

    fn first(&self, count: usize) -> Inputs<'_> {
        Inputs { words: bits_of(&self.words[..count * self.pixels]), largest: &self.largest[..count] }
    }

    fn vectors(&self, count: usize) -> Vectors<'_> {
        let words = bits_of(&self.words[..count * self.pixels]);
        Vectors { words, stride: self.pixels, columns: self.pixels }
    }
}

/// What a layer sends.
fn sent(layer: &LayerWords) -> &[i16] {
    if layer.sent.is_empty() { &layer.z } else { &layer.sent }
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
        let accumulator_bits = network.accumulator_bits();
        Self {
            isa,
            analysis: Packed::new(&network.analysis.weights),
            stages: (0..network.form.shrinkages())
                .map(|t| Stage::new(&network, t, accumulator_bits[t]))
                .collect(),
            recurrent: network.recurrent.iter().map(|s| Columns::new(&s.weights)).collect(),
            dictionary: Columns::new(&network.dictionary.weights),
            linear_path: network.linear_path.as_ref().map(|r| Packed::new(&r.weights)),
            tiled: TiledNetwork::new(&network, isa),
            finish: FinishOutputs {
                shifts: network.final_shifts(),
                accumulator_bits: accumulator_bits[network.form.layers - 1],
            },
            network,
        }
    }

    /// The network.
    #[must_use]
    pub const fn network(&self) -> &FixedNetwork {
        &self.network
    }

    /// Every boundary of each window: `windows` holds `window.pixels()` input words (0 or more) a window, one after the other.
    #[must_use]
    pub fn traces(&self, windows: &[InputWord]) -> Vec<Trace> {
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

    /// Runs `count` patches (at most [`Batch::PATCHES`]); `fill(i, words)` writes the input words (0 or more) of the i-th.
    pub fn run(&self, batch: &mut Batch, count: usize, fill: impl FnMut(usize, &mut [InputWord])) {
        let count = count.min(Batch::PATCHES);
        batch.windows.fill(count, fill);
        if self.tiled.is_none() {
            batch.windows.bound(self.isa, count);
        }
        if self.fits() {
            (0..self.stages.len()).for_each(|t| self.layer(batch, t, count));
            self.outputs(batch, count);
        } else {
            for i in 0..count {
                let trace = scalar::run(&self.network, batch.windows.window(i));
                batch.set(i, &trace);
            }
        }
    }

    /// Whether all sums fit the kernels' 40 bits.
    fn fits(&self) -> bool {
        let dense = [&self.analysis].into_iter().chain(&self.linear_path).all(Packed::fits);
        dense && [&self.dictionary].into_iter().chain(&self.recurrent).all(Columns::fits)
    }

    /// The matrix that stage t's words are multiplied by (0 = I).
    fn after(&self, t: usize) -> &Columns {
        let middle = t + 1 < self.stages.len();
        if middle { &self.recurrent[self.network.form.recurrent_index(t)] } else { &self.dictionary }
    }

    /// Stage t (0 = I): b, z and what it sends, for `count` patches.
    fn layer(&self, batch: &mut Batch, t: usize, count: usize) {
        let (rows, bits, shrinkage) =
            (padded(batch.codes), self.network.code_bits, self.network.form.shrinkage);
        let stage = &self.stages[t];
        let (before, rest) = batch.words.split_at_mut(t);
        let sent_before = before.last().map(sent);
        let LayerWords { b, z, sent } = &mut rest[0];
        let wants_low = !stage.finish.is_narrow();
        match (&self.tiled, t.checked_sub(1)) {
            (None, None) => {
                kernels::dense(self.isa, &self.analysis, batch.windows.first(count), &mut batch.sums);
            }
            (None, Some(last)) => {
                kernels::sparse(self.isa, self.after(last), &batch.active, count, &mut batch.sums);
            }
            (Some(tiled), None) => {
                let (vectors, sums) = (batch.windows.vectors(count), (&mut batch.sums, wants_low));
                amx::dense(tiled.token, &tiled.analysis, vectors, &mut batch.planes, sums);
            }
            (Some(tiled), Some(last)) => {
                let words = &sent_before.unwrap_or_default()[..count * rows];
                let vectors = Vectors { words, stride: rows, columns: batch.codes };
                let sums = (&mut batch.sums, wants_low);
                amx::dense(tiled.token, &tiled.after[last], vectors, &mut batch.planes, sums);
            }
        }
        let base = match self.network.form.recurrence {
            Recurrence::Direct => before.first(),
            Recurrence::Difference => before.last(),
        };
        batch.active.clear();
        for i in 0..count {
            let (at, counts) = (i * rows..(i + 1) * rows, &mut batch.stages[i * batch.layers + t]);
            let (b, z) = (&mut b[at.clone()], &mut z[at.clone()]);
            let base = base.map(|base| &base.b[at.clone()]);
            *counts = StageCounts::default();
            counts.saturated_results = stage.finish.words(self.isa, &batch.sums, at.start, base, b);
            counts.saturated_codes = finish::shrink(self.isa, shrinkage, bits, &stage.theta, b, z);
            let sent = match before.last() {
                _ if !stage.sends_difference => z,
                last => {
                    let sent = &mut sent[at.clone()];
                    match last {
                        Some(last) => {
                            counts.saturated_differences =
                                finish::difference(self.isa, bits, z, &last.z[at.clone()], sent);
                        }
                        None => sent.copy_from_slice(z),
                    }
                    sent
                }
            };
            counts.nonzeros = match self.tiled {
                Some(_) => amx::nonzeros(self.isa, sent),
                None => batch.active.push(self.isa, sent, self.after(t).largest),
            };
        }
    }

    /// F's words of `count` patches.
    fn outputs(&self, batch: &mut Batch, count: usize) {
        if let Some(tiled) = &self.tiled {
            let (rows, last) = (padded(batch.codes), self.stages.len() - 1);
            let words = &sent(&batch.words[last])[..count * rows];
            let vectors = Vectors { words, stride: rows, columns: batch.codes };
            let sums = (&mut batch.sums, true);
            amx::dense(tiled.token, &tiled.after[last], vectors, &mut batch.planes, sums);
            if let Some(r) = &tiled.linear_path {
                let sums = (&mut batch.linear, true);
                amx::dense(tiled.token, r, batch.windows.vectors(count), &mut batch.planes, sums);
            }
        } else {
            kernels::sparse(self.isa, &self.dictionary, &batch.active, count, &mut batch.sums);
            if let Some(r) = &self.linear_path {
                kernels::dense(self.isa, r, batch.windows.first(count), &mut batch.linear);
            }
        }
        let linear = self.linear_path.is_some().then_some(&batch.linear);
        for (i, out) in batch.output.chunks_exact_mut(OUTPUTS_422).take(count).enumerate() {
            let saturated = self.finish.words(self.isa, &batch.sums, linear, i * OUTPUTS_422, out);
            let counts = StageCounts { saturated_results: saturated, ..StageCounts::default() };
            batch.stages[(i + 1) * batch.layers - 1] = counts;
        }
    }
}

impl Stage {
    /// Stage t (0 = I) of a checked network.
    fn new(network: &FixedNetwork, t: usize, accumulator_bits: u32) -> Self {
        let (base_shift, shift) = match t.checked_sub(1) {
            None => (None, network.analysis_shift()),
            Some(middle) => {
                let shifts = network.middle_shifts(middle);
                (Some(shifts.base), shifts.result)
            }
        };
        let mut theta = network.thresholds[t].to_vec();
        theta.resize(padded(network.form.codes), 0);
        Self {
            finish: Finish { base_shift, shift, bits: network.code_bits, accumulator_bits },
            theta,
            sends_difference: sends_difference(network, t),
        }
    }
}
