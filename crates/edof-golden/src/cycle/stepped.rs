//! The same contract as a machine that steps through every cycle: registers in, registers out. It shares nothing with
//! [`super::chain`] but sizes and constants, is slow on purpose, and proves the other's recurrences (tests/cycle.rs).

use super::Stalls;
use crate::Trace;
use edof_core::number::bits_of;
use edof_device::Design;
use edof_device::design::reading::stolen;
use edof_device::design::timing::{
    ARRIVAL_LATENCY, BASE_VECTORS, CREDIT_LATENCY, DRAIN_CREDITS, PASS_SPACING, RELEASE_LATENCY, SLOTS,
    SUM_LATENCY, release,
};
use edof_device::design::{BEAT, StagePlan};
use std::collections::{BTreeSet, VecDeque};

/// Steps a design through patches, from reset until the last result is out. Gives the cycles of all transfers at each boundary.
///
/// # Panics
/// When a stage would have to hold more bases than [`BASE_VECTORS`]: a flaw of the contract, which lets no beat wait for them.
///
/// In each cycle of `writes` a word is written to an address; each trace's window comes in as many beats as `windows` says.
#[must_use]
pub fn run(
    design: &Design,
    skip_zeros: bool,
    stalls: Stalls,
    writes: &[(u64, u32, u32)],
    windows: &[usize],
    traces: &[Trace],
) -> Vec<Vec<u64>> {
    let mut machine = Machine::new(design, skip_zeros, windows, traces);
    let stolen: Vec<BTreeSet<u64>> =
        (0..design.stages.len()).map(|stage| stolen(design, stage, writes)).collect();
    let results: usize = traces.iter().map(|trace| trace.output.len() / BEAT).sum();
    let mut cycles = vec![vec![]; design.stages.len() + 1];
    for cycle in 0.. {
        // A last window that is too long may still come when its result is out.
        if machine.left.is_empty() && cycles.last().is_none_or(|out: &Vec<u64>| out.len() == results) {
            break;
        }
        let transfers = machine
            .step(stalls.source.go(cycle), stalls.sink.go(cycle), |stage| stolen[stage].contains(&cycle));
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
    /// Beats of each window that the source has not sent yet.
    left: VecDeque<usize>,
    guard: Guard,
    /// F's window ring.
    ring: Ring,
}

/// What makes windows whole.
struct Guard {
    beats_of_window: usize,
    /// Beats of the window in progress.
    beats: usize,
    /// Whether the window is filled up.
    fills: bool,
    /// Whether the rest of the window is thrown away.
    drops: bool,
}

/// F's window ring.
struct Ring {
    /// Slots of the window ring; 0 where F has no linear path.
    places: usize,
    held: usize,
    /// Beats of the window that comes in.
    beats: usize,
    beats_of_window: usize,
}

impl Machine {
    fn new(design: &Design, skip_zeros: bool, windows: &[usize], traces: &[Trace]) -> Self {
        let stages: Vec<Stage> = design.stages().map(|plan| Stage::new(plan, skip_zeros, traces)).collect();
        let beats_of_window = stages[0].plan.beats_in();
        let places = stages.last().map_or(0, |f| f.plan.kept_windows);
        Self {
            pending: false,
            left: windows.iter().copied().collect(),
            guard: Guard { beats_of_window, beats: 0, fills: false, drops: false },
            ring: Ring { places, held: 0, beats: 0, beats_of_window },
            stages,
        }
    }

    /// One cycle: whether a transfer happened at each boundary.
    fn step(&mut self, source_goes: bool, sink_goes: bool, stolen: impl Fn(usize) -> bool) -> Vec<bool> {
        // All wires follow from registers and from the two ends.
        let presented = self.pending || (!self.left.is_empty() && source_goes);
        let Guard { fills, drops, .. } = self.guard;
        let valid =
            |b: usize| if b == 0 { fills || (presented && !drops) } else { self.stages[b - 1].fifo > 0 };
        let ready =
            |b: usize| self.stages.get(b).map_or(sink_goes, Stage::ready) && (b > 0 || self.ring.ready());
        let mut transfers: Vec<bool> = (0..=self.stages.len()).map(|b| valid(b) && ready(b)).collect();
        let taken = presented && (drops || (transfers[0] && !fills));
        // All registers change at once.
        self.pending = presented && !taken;
        let last = taken && self.sent();
        self.guard.step(transfers[0], taken, last);
        let stages = self.stages.iter_mut().enumerate();
        let finished = stages.map(|(s, stage)| stage.step(transfers[s], transfers[s + 1], stolen(s)));
        let f_finished = finished.fold(false, |_, finished| finished);
        self.ring.step(transfers[0], f_finished);
        transfers[0] = taken;
        transfers
    }

    /// Sends a beat; returns whether it was its window's last.
    fn sent(&mut self) -> bool {
        let Some(left) = self.left.front_mut() else { return false };
        *left -= 1;
        let last = *left == 0;
        if last {
            self.left.pop_front();
        }
        last
    }
}

impl Guard {
    /// A beat is passed on or not, one of the source is taken or not, as the last that it sends of its window or not.
    fn step(&mut self, goes: bool, taken: bool, last: bool) {
        let at_end = self.beats + 1 == self.beats_of_window;
        if goes {
            self.beats = if at_end { 0 } else { self.beats + 1 };
            self.drops = at_end && taken && !last;
            self.fills = !at_end && (self.fills || last);
        } else if taken && last {
            self.drops = false;
        }
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
    /// Vectors on their way from the last beat to the sequencer.
    arriving: Delay,
    /// Vectors with a pass that can start or has started.
    known: usize,
    /// Passes over the oldest full slot that are over.
    pass: usize,
    /// Steps of the pass still to issue; 0 between passes.
    steps: usize,
    /// Cycles until a pass may start after the one before.
    spacing: u64,
    /// Passes begun and not released.
    open: usize,
    releasing: Delay,
    /// Last steps on their way through the DSPs.
    summing: Delay,
    /// Passes whose sums stand in the DSPs.
    sums: usize,
    /// Takes left in the holding registers.
    holding: usize,
    /// Whether the drain of these has begun.
    takes_on: bool,
    credits: usize,
    returning: Delay,
    /// Takes until the last of a vector's last pass.
    takes: usize,
    /// Vectors with a beat received and the last take not over: their bases are held.
    bases: usize,
    /// Results on their way from holding registers to the output.
    draining: Delay,
    /// Beats that stand on the output or behind it.
    fifo: usize,
}

impl Stage {
    fn new(plan: StagePlan, skip_zeros: bool, traces: &[Trace]) -> Self {
        let vector = |trace| -> &[i16] { vector_into(plan.index, trace) };
        let keeps = |word: &&i16| plan.index == 0 || !skip_zeros || **word != 0;
        let appended = |beat: &[i16]| beat.iter().filter(keeps).count();
        Self {
            plan,
            coming: traces.iter().flat_map(|trace| vector(trace).chunks(BEAT).map(appended)).collect(),
            filling: (0, 0),
            full: VecDeque::new(),
            arriving: Delay::new(ARRIVAL_LATENCY),
            known: 0,
            pass: 0,
            steps: 0,
            spacing: 0,
            open: 0,
            releasing: Delay::new(RELEASE_LATENCY),
            summing: Delay::new(SUM_LATENCY),
            sums: 0,
            holding: 0,
            takes_on: false,
            credits: DRAIN_CREDITS,
            returning: Delay::new(CREDIT_LATENCY),
            takes: plan.beats_out(),
            bases: 0,
            draining: Delay::new(plan.drain_latency()),
            fifo: 0,
        }
    }

    fn ready(&self) -> bool {
        self.full.len() < SLOTS
    }

    /// One cycle, with or without a beat in, a beat out and a step; returns whether a vector's last pass finished.
    fn step(&mut self, beat_in: bool, beat_out: bool, stolen: bool) -> bool {
        let copies = self.sums > 0 && (self.holding == 0 || (self.takes_on && self.holding == 1));
        let begins = self.holding > 0 && !self.takes_on && self.credits >= self.holding;
        self.takes_on |= begins;
        let (last_step, finished) = self.sequence(stolen);
        self.drain(copies, last_step, beat_out);
        if finished {
            self.full.pop_front();
            self.known -= 1;
        }
        let whole = beat_in && self.append();
        self.known += usize::from(self.arriving.step(whole));
        finished
    }

    /// One step of a pass, if there is one to make: whether it is the pass's last, and the vector's.
    fn sequence(&mut self, stolen: bool) -> (bool, bool) {
        self.spacing = self.spacing.saturating_sub(1);
        if self.steps == 0 && self.known > 0 && self.open < 2 && self.spacing == 0 {
            let rows = self.plan.rows;
            self.steps = self.full[0].div_ceil(rows).max(1) + self.plan.linear.div_ceil(rows);
            self.open += 1;
            self.spacing = PASS_SPACING;
        }
        if self.steps == 0 || stolen {
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

    /// Sums to holding registers, on to the output.
    fn drain(&mut self, copies: bool, last_step: bool, beat_out: bool) {
        let beats = self.plan.drain_beats();
        self.sums += usize::from(self.summing.step(last_step));
        self.fifo += usize::from(self.draining.step(self.takes_on));
        let released = self.takes_on && (beats - self.holding) as u64 == release(beats);
        self.open -= usize::from(self.releasing.step(released));
        if self.takes_on {
            self.holding -= 1;
            self.credits -= 1;
            self.takes_on = self.holding > 0;
            self.takes -= 1;
            if self.takes == 0 {
                self.takes = self.plan.beats_out();
                self.bases -= 1;
            }
        }
        if copies {
            self.sums -= 1;
            self.holding = beats;
        }
        self.fifo -= usize::from(beat_out);
        self.credits += usize::from(self.returning.step(beat_out));
    }

    /// Adds a beat to the slot that fills; returns whether it is full then.
    fn append(&mut self) -> bool {
        if self.filling.1 == 0 {
            self.bases += 1;
            assert!(self.bases <= BASE_VECTORS, "stage {} holds {} bases", self.plan.index, self.bases);
        }
        self.filling.0 += self.coming.pop_front().unwrap_or(0);
        self.filling.1 += 1;
        let whole = self.filling.1 == self.plan.beats_in();
        if whole {
            self.full.push_back(self.filling.0);
            self.filling = (0, 0);
        }
        whole
    }
}

/// The vector that comes to stage `index`.
fn vector_into(index: usize, trace: &Trace) -> &[i16] {
    if index == 0 { bits_of(&trace.input) } else { &trace.layers[index - 1].sent }
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
