//! The same contract as a machine that steps through every cycle: registers in, registers out. It shares nothing with
//! [`super::chain`] but sizes and constants, is slow on purpose, and proves the other's recurrences (tests/cycle.rs).

use super::Stalls;
use crate::Trace;
use edof_spec::Design;
use edof_spec::design::timing::{BASE_VECTORS, DRAIN_CREDITS, DRAIN_LATENCY, SUM_LATENCY};
use edof_spec::design::{BEAT, StagePlan};
use std::collections::VecDeque;

/// Steps a design through patches, from reset until the last result is out. Gives the cycles of all transfers at each boundary.
///
/// # Panics
/// When a stage would have to hold more bases than [`BASE_VECTORS`]: a flaw of the contract, which lets no beat wait for them.
#[must_use]
pub fn run(design: &Design, skip_zeros: bool, stalls: Stalls, traces: &[Trace]) -> Vec<Vec<u64>> {
    let mut machine = Machine::new(design, skip_zeros, traces);
    let results: usize = traces.iter().map(|trace| trace.output.len() / BEAT).sum();
    let mut cycles = vec![vec![]; design.stages.len() + 1];
    for cycle in 0.. {
        if cycles.last().is_none_or(|out: &Vec<u64>| out.len() == results) {
            break;
        }
        let transfers = machine.step(stalls.source.go(cycle), stalls.sink.go(cycle));
        for (cycles, transfer) in cycles.iter_mut().zip(transfers) {
            cycles.extend(transfer.then_some(cycle));
        }
    }
    cycles
}

/// All registers, and the words that will pass.
struct Machine {
    stages: Vec<Stage>,
    /// Whether the source presents a beat.
    pending: bool,
    /// Beats that the source has not sent yet.
    left: usize,
    /// F's window ring.
    ring: Ring,
}

/// F's window ring.
struct Ring {
    /// Its size; 0 where F has no linear path.
    places: usize,
    held: usize,
    /// Beats of the window that comes in.
    beats: usize,
    beats_of_window: usize,
}

impl Machine {
    fn new(design: &Design, skip_zeros: bool, traces: &[Trace]) -> Self {
        let stages: Vec<Stage> = design.stages().map(|plan| Stage::new(plan, skip_zeros, traces)).collect();
        let beats_of_window = stages[0].plan.beats_in();
        let places = stages.last().map_or(0, |f| f.plan.kept_windows);
        Self {
            pending: false,
            left: traces.len() * beats_of_window,
            ring: Ring { places, held: 0, beats: 0, beats_of_window },
            stages,
        }
    }

    /// One cycle: whether a transfer happened at each boundary.
    fn step(&mut self, source_goes: bool, sink_goes: bool) -> Vec<bool> {
        // All wires follow from registers and from the two ends.
        let presented = self.pending || (self.left > 0 && source_goes);
        let valid = |b: usize| if b == 0 { presented } else { self.stages[b - 1].fifo > 0 };
        let ready =
            |b: usize| self.stages.get(b).map_or(sink_goes, Stage::ready) && (b > 0 || self.ring.ready());
        let transfers: Vec<bool> = (0..=self.stages.len()).map(|b| valid(b) && ready(b)).collect();
        // All registers change at once.
        self.pending = presented && !transfers[0];
        self.left -= usize::from(transfers[0]);
        let finished =
            self.stages.iter_mut().enumerate().map(|(s, stage)| stage.step(transfers[s], transfers[s + 1]));
        let f_finished = finished.fold(false, |_, finished| finished);
        self.ring.step(transfers[0], f_finished);
        transfers
    }
}

impl Ring {
    fn ready(&self) -> bool {
        self.places == 0 || self.held < self.places
    }

    fn step(&mut self, beat_in: bool, finished: bool) {
        if self.places == 0 {
            return;
        }
        self.beats += usize::from(beat_in);
        if self.beats == self.beats_of_window {
            self.beats = 0;
            self.held += 1;
        }
        self.held -= usize::from(finished);
    }
}

/// One stage's registers. Every field holds what is visible in the cycle that comes.
struct Stage {
    plan: StagePlan,
    /// Pairs that each coming beat appends.
    coming: VecDeque<usize>,
    /// Pairs and beats in the slot that fills.
    filling: (usize, usize),
    /// Pairs in the slots that are full, oldest first.
    full: VecDeque<usize>,
    /// Which pass over the oldest full slot is on or comes next.
    pass: usize,
    /// Steps of the pass still to issue; 0 between passes.
    steps: usize,
    /// Passes begun whose drain is not over.
    open: usize,
    /// Last steps on their way through the DSPs.
    summing: Delay,
    /// Passes whose sums stand in the DSPs.
    sums: usize,
    /// Takes left in the holding registers.
    holding: usize,
    credits: usize,
    /// Takes until the last of a vector's last pass.
    takes: usize,
    /// Vectors of which a beat came in and whose last take is not over: their bases are held.
    bases: usize,
    /// Results on their way from holding registers to FIFO.
    draining: Delay,
    /// Beats in the FIFO.
    fifo: usize,
}

impl Stage {
    fn new(plan: StagePlan, skip_zeros: bool, traces: &[Trace]) -> Self {
        let vector = |trace| -> &Vec<i16> { vector_into(plan.index, trace) };
        let appended = |beat: &[i16]| beat.iter().filter(|word| !skip_zeros || **word != 0).count();
        Self {
            plan,
            coming: traces.iter().flat_map(|trace| vector(trace).chunks(BEAT).map(appended)).collect(),
            filling: (0, 0),
            full: VecDeque::new(),
            pass: 0,
            steps: 0,
            open: 0,
            summing: Delay::new(SUM_LATENCY),
            sums: 0,
            holding: 0,
            credits: DRAIN_CREDITS,
            takes: plan.beats_out(),
            bases: 0,
            draining: Delay::new(DRAIN_LATENCY),
            fifo: 0,
        }
    }

    fn ready(&self) -> bool {
        self.full.len() < 2
    }

    /// One cycle, with or without a beat in and a beat out; tells whether a vector's last pass finished.
    fn step(&mut self, beat_in: bool, beat_out: bool) -> bool {
        let (copies, takes) = (self.sums > 0 && self.holding == 0, self.holding > 0 && self.credits > 0);
        let (last_step, finished) = self.sequence();
        self.drain(copies, takes, last_step, beat_out);
        if finished {
            self.full.pop_front();
        }
        if beat_in {
            self.append();
        }
        finished
    }

    /// One step of a pass, if there is one to make: whether it is the pass's last, and the vector's.
    fn sequence(&mut self) -> (bool, bool) {
        let begins = self.steps == 0 && !self.full.is_empty() && self.open < 2;
        if begins {
            let rows = self.plan.rows;
            self.steps = self.full[0].div_ceil(rows).max(1) + self.plan.linear.div_ceil(rows);
            self.open += 1;
        }
        if self.steps == 0 {
            return (false, false);
        }
        self.steps -= 1;
        let last_step = self.steps == 0;
        self.pass += usize::from(last_step);
        let finished = self.pass == self.plan.passes();
        if finished {
            self.pass = 0;
        }
        (last_step, finished)
    }

    /// Sums to holding registers, on to the FIFO, out.
    fn drain(&mut self, copies: bool, takes: bool, last_step: bool, beat_out: bool) {
        self.sums += usize::from(self.summing.step(last_step));
        self.fifo += usize::from(self.draining.step(takes));
        if takes {
            self.holding -= 1;
            self.credits -= 1;
            self.open -= usize::from(self.holding == 0);
            self.takes -= 1;
            if self.takes == 0 {
                self.takes = self.plan.beats_out();
                self.bases -= 1;
            }
        }
        if copies {
            self.sums -= 1;
            self.holding = self.plan.drain_beats();
        }
        if beat_out {
            self.fifo -= 1;
            self.credits += 1;
        }
    }

    /// A beat into the slot that fills.
    fn append(&mut self) {
        if self.filling.1 == 0 {
            self.bases += 1;
            assert!(self.bases <= BASE_VECTORS, "stage {} holds {} bases", self.plan.index, self.bases);
        }
        self.filling.0 += self.coming.pop_front().unwrap_or(0);
        self.filling.1 += 1;
        if self.filling.1 == self.plan.beats_in() {
            self.full.push_back(self.filling.0);
            self.filling = (0, 0);
        }
    }
}

/// The vector that comes to stage `index`.
fn vector_into(index: usize, trace: &Trace) -> &Vec<i16> {
    if index == 0 { &trace.input } else { &trace.layers[index - 1].sent }
}

/// A line of registers: what goes in comes out such that its effect is visible `latency` cycles later.
struct Delay(VecDeque<bool>);

impl Delay {
    fn new(latency: u64) -> Self {
        Self((1..latency).map(|_| false).collect())
    }

    fn step(&mut self, input: bool) -> bool {
        self.0.push_back(input);
        self.0.pop_front().unwrap_or(false)
    }
}
