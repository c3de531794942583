//! Patches through a circuit, compared with the cycle model as they pass.

use super::check::{Boundary, Difference, Fault, stage_names};
use super::device::{Beat, Device, Inputs, Offer, Outputs, status_address};
use crate::Error;
use edof_device::design::memory::{self, Space};
use edof_device::design::{StagePlan, timing};
use edof_golden::StageCounts;
use edof_golden::cycle::{Cycle, Patch, PatchRun, Run, StallPattern, Stalls, Summary};
use std::collections::VecDeque;

/// Cycles of reset: enough for every pipeline to run dry.
const RESET_CYCLES: usize = 48;
/// The cycle of a flush in which the counters restart: what was in progress has been counted.
const COUNTED: usize = RESET_CYCLES - 4;
/// Cycles after a write until all that it changes is changed.
const SETTLE_CYCLES: usize = 8;
/// Cycles after reset or flush until windows are taken.
const IDLE_CYCLES: usize = 2;
/// While patches run, a word is written once in this number of cycles.
const WRITE_EVERY: u64 = 3;
/// Cycles after the last patch in which nothing may come.
const QUIET_CYCLES: u64 = 50;

/// How patches are driven.
#[derive(Debug, Clone, Default)]
pub struct Drive {
    /// Begins with a flush in place of a reset: what was written before stays.
    pub flush: bool,
    /// Whether zeros are left out, where that is not what the design says.
    pub skip_zeros: Option<bool>,
    /// Stalls of source and sink.
    pub stalls: Option<Stalls>,
    /// Words written before the first patch.
    pub writes: Vec<(u32, u32)>,
    /// Words written while patches run, one every three cycles.
    pub writes_while_running: Vec<(u32, u32)>,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Figures of the model, which the circuit shares where there is no difference.
    pub summary: Summary,
    /// Beats that passed as they should, at all boundaries.
    pub beats: u64,
    /// Cycles of reset and writing before cycle 0.
    pub lead: u64,
    /// Cycles run from cycle 0 on.
    pub cycles: u64,
    /// The first difference.
    pub difference: Option<Difference>,
}

/// Called after every patch that the model has made: patches so far.
pub type Progress<'a> = &'a mut dyn FnMut(u64);

impl Drive {
    /// Runs patches through `device` and compares every boundary in every cycle with `model`.
    ///
    /// # Errors
    /// The simulation stops. A difference is no error but an outcome.
    pub fn run(
        &self,
        model: Cycle,
        patches: impl IntoIterator<Item = Patch>,
        device: &mut impl Device,
        progress: Progress<'_>,
    ) -> Result<Outcome, Error> {
        let design = model.design().clone();
        let stalls = self.stalls.unwrap_or(Stalls::NEVER);
        let model = model.stalls(stalls);
        let model = match self.skip_zeros {
            Some(skip) => model.skip_zeros(skip),
            None => model,
        };
        let writes = (0..).step_by(WRITE_EVERY as usize).zip(&self.writes_while_running);
        let model = model.writes(writes.map(|(cycle, (address, word))| (cycle, *address, *word)).collect());
        let stages = design.stages.len();
        let lead = self.begin(stages, device)?;
        let mut reference = Reference {
            source: Source { beats: VecDeque::new(), pending: false, stalls: stalls.source },
            boundaries: Boundary::all(stages),
            summary: Summary::new(&design),
            runs: model.run(patches),
            ahead: 2 + design.stages().map(|stage| max_held(&stage)).sum::<usize>(),
            held: 0,
            progress,
        };
        let mut writes = self.writes_while_running.iter().copied().peekable();
        let (mut cycle, mut end, mut outputs) = (0, None, Outputs::default());
        let difference = loop {
            reference.refill();
            let inputs = Inputs {
                window: reference.source.offer(cycle),
                patch_ready: stalls.sink.go(cycle),
                write: if cycle % WRITE_EVERY == 0 { writes.next() } else { None },
                ..Inputs::default()
            };
            device.cycle(&inputs, &mut outputs)?;
            if let Err(difference) = reference.compare(cycle, &inputs, &outputs) {
                break Some(*difference);
            }
            cycle += 1;
            if reference.is_done()
                && writes.peek().is_none()
                && *end.get_or_insert(cycle + QUIET_CYCLES) <= cycle
            {
                break self.counters(&reference.summary, cycle, device)?;
            }
        };
        let beats = reference.boundaries.iter().map(|b| b.passed).sum();
        Ok(Outcome { summary: reference.summary, beats, lead, cycles: cycle, difference })
    }

    /// Resets or flushes the circuit and writes the pending words; returns the cycles that took.
    fn begin(&self, stages: usize, device: &mut impl Device) -> Result<u64, Error> {
        let mut outputs = Outputs::default();
        let mut cycles = RESET_CYCLES as u64;
        for cycle in 0..RESET_CYCLES {
            let write = (self.flush && cycle == COUNTED).then_some((memory::SNAPSHOT, 0));
            let inputs = Inputs { reset: !self.flush, flush: self.flush, write, ..Inputs::default() };
            device.cycle(&inputs, &mut outputs)?;
        }
        let skip = self.skip_zeros.iter().flat_map(|skip| {
            let control = |stage| memory::address(stage, Space::Register { row: 2 });
            (0..stages).map(move |stage| (control(stage), u32::from(*skip) * memory::CONTROL_SKIP))
        });
        let mut writes: Vec<_> = skip.chain(self.writes.iter().copied()).map(Some).collect();
        let idle = if writes.is_empty() { IDLE_CYCLES } else { SETTLE_CYCLES };
        writes.resize(writes.len() + idle, None);
        for write in writes {
            device.cycle(&Inputs { write, ..Inputs::default() }, &mut outputs)?;
            cycles += 1;
        }
        Ok(cycles)
    }

    /// Compares the counters of all stages and of the whole chain.
    fn counters(
        &self,
        summary: &Summary,
        cycle: u64,
        device: &mut impl Device,
    ) -> Result<Option<Difference>, Error> {
        let mut outputs = Outputs::default();
        for write in [Some((memory::SNAPSHOT, 0))].into_iter().chain([None; SETTLE_CYCLES]) {
            device.cycle(&Inputs { write, ..Inputs::default() }, &mut outputs)?;
        }
        for Counted { stage, name, counter, expected } in counted(summary) {
            let status_address = status_address(stage, counter);
            for _ in 0..2 {
                device.cycle(&Inputs { status_address, ..Inputs::default() }, &mut outputs)?;
            }
            if u64::from(outputs.status) != expected & 0xffff_ffff {
                return Ok(Some(Difference {
                    fault: Fault::Counter,
                    boundary: "counters".into(),
                    stage: name,
                    patch: 0,
                    element: counter,
                    cycle,
                    expected: expected as i64,
                    got: Some(outputs.status.into()),
                }));
            }
        }
        Ok(None)
    }
}

/// A counter, and what it must show.
struct Counted {
    stage: usize,
    name: String,
    counter: usize,
    expected: u64,
}

/// What all counters must show after a run.
fn counted(summary: &Summary) -> Vec<Counted> {
    let stages = &summary.counts.stages;
    let of_stage = |counts: &StageCounts| {
        [counts.nonzeros, counts.saturated_results, counts.saturated_codes, counts.saturated_differences]
    };
    let mut all: Vec<Counted> = vec![];
    for ((stage, counts), name) in stages.iter().enumerate().zip(stage_names(stages.len())) {
        // F sends no pairs: the model does not count its non-zero results.
        let first = usize::from(stage + 1 == stages.len());
        let counters = of_stage(counts).into_iter().enumerate().skip(first);
        all.extend(counters.map(|(counter, expected)| Counted {
            stage,
            name: name.clone(),
            counter,
            expected,
        }));
    }
    let windows = [summary.too_short, summary.too_long].into_iter().enumerate();
    all.extend(windows.map(|(counter, expected)| Counted {
        stage: memory::WHOLE_CHAIN,
        name: "windows".into(),
        counter,
        expected,
    }));
    all
}

/// More vectors than a stage ever holds: in its slots, three in its multipliers and drain, and what its credits let out.
const fn max_held(stage: &StagePlan) -> usize {
    timing::SLOTS + 4 + timing::DRAIN_CREDITS.div_ceil(stage.beats_out())
}

/// The beats of windows, presented as the stall pattern allows.
struct Source {
    beats: VecDeque<Beat>,
    pending: bool,
    stalls: StallPattern,
}

impl Source {
    /// The beat that stands on the input in this cycle.
    fn offer(&mut self, cycle: u64) -> Option<Beat> {
        if !self.pending {
            self.pending = !self.beats.is_empty() && self.stalls.go(cycle);
        }
        self.beats.front().filter(|_| self.pending).copied()
    }

    fn taken(&mut self) {
        self.beats.pop_front();
        self.pending = false;
    }
}

/// The reference of the circuit: the model, and the source that feeds both.
struct Reference<'a, 'p, I> {
    source: Source,
    boundaries: Vec<Boundary>,
    summary: Summary,
    runs: Run<'a, I>,
    ahead: usize,
    held: usize,
    progress: Progress<'p>,
}

impl<I: Iterator<Item = Patch>> Reference<'_, '_, I> {
    /// Keeps the model a few patches ahead of the circuit.
    fn refill(&mut self) {
        while self.held < self.ahead {
            let Some(run) = self.runs.next() else { return };
            self.add(&run);
        }
    }

    fn add(&mut self, run: &PatchRun) {
        let beats = run.transfers(0);
        self.source.beats.extend(beats.map(|t| Beat {
            words: t.words,
            base: [0; 2],
            last: t.last,
            set: t.set,
        }));
        self.boundaries.iter_mut().enumerate().for_each(|(b, boundary)| boundary.expect(run, b));
        self.summary.add(run);
        self.held += 1;
        (self.progress)(self.summary.counts.patches);
    }

    fn compare(&mut self, cycle: u64, inputs: &Inputs, outputs: &Outputs) -> Result<(), Box<Difference>> {
        let window = Offer { beat: inputs.window, ready: outputs.window_ready };
        let patch = Offer { beat: outputs.patch, ready: inputs.patch_ready };
        let offers = std::iter::once(window).chain(outputs.between.iter().copied()).chain([patch]);
        for (boundary, offer) in self.boundaries.iter_mut().zip(offers) {
            boundary.see(cycle, offer)?;
        }
        if window.passes().is_some() {
            self.source.taken();
        }
        if patch.passes().is_some_and(|beat| beat.last) {
            self.held -= 1;
        }
        Ok(())
    }

    fn is_done(&self) -> bool {
        self.held == 0 && self.boundaries.iter().all(|b| b.next().is_none())
    }
}
