//! The order of a module's text: each signal is declared where it gets its value, before it is read.

use std::collections::{BTreeMap, BTreeSet};

use crate::expression::{Expression, Node};
use crate::process::Process;
use crate::scope::{Role, Scope, SignalId};

/// What stands in the text: an assignment or block, or an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// Index into the processes.
    Process(usize),
    /// Index into the scope's parts.
    Part(usize),
}

/// The steps in order.
#[derive(Debug, Default)]
pub(crate) struct Order {
    pub steps: Vec<Step>,
    /// Signals that go round: something reads them above the step that gives them their value.
    pub early: BTreeSet<SignalId>,
}

/// The signals that a process declares.
pub(crate) fn declared(scope: &Scope, process: &Process) -> impl Iterator<Item = SignalId> {
    let is_own = move |id: &SignalId| scope.signals[*id].role != Role::Output;
    let targets = process.targets.iter().copied().filter(is_own);
    targets.filter(move |_| process.is_combinational())
}

/// Combinational processes and instances in the order of the kernel, each after those that declare what it reads. `parts` are the instances and
/// their pins, `resolved` is what stands for each signal.
pub(crate) fn order(
    scope: &Scope,
    processes: &[Process],
    parts: &[(usize, Vec<SignalId>)],
    resolved: &[Expression],
) -> Order {
    let combinational = processes.iter().enumerate().filter(|(_, process)| process.is_combinational());
    let processes = combinational
        .map(|(n, process)| Piece::new(Step::Process(n), declared(scope, process), &process.reads));
    let parts = parts.iter().map(|(n, pins)| {
        let with = |role: Role| pins.iter().copied().filter(move |id| scope.signals[*id].role == role);
        let inputs: BTreeSet<SignalId> = with(Role::PartInput).collect();
        Piece::new(Step::Part(*n), with(Role::PartOutput), &inputs)
    });
    let pieces: Vec<Piece> = processes.chain(parts).collect();
    let sources = pieces.iter().enumerate();
    let sources = sources.flat_map(|(n, piece)| piece.declares.iter().map(move |id| (*id, n))).collect();
    let mut ordering = Ordering { pieces: &pieces, resolved, sources, seen: BTreeSet::new(), order: vec![] };
    // What feeds an instance stands above it.
    let is_feed = |piece: &Piece| {
        let is_input = |id: &SignalId| scope.signals[*id].role == Role::PartInput;
        matches!(piece.step, Step::Process(_))
            && !piece.declares.is_empty()
            && piece.declares.iter().all(is_input)
    };
    let (feeds, others): (Vec<usize>, Vec<usize>) = (0..pieces.len()).partition(|n| is_feed(&pieces[*n]));
    others.into_iter().chain(feeds).for_each(|n| ordering.add(n, usize::MAX));
    ordering.finish()
}

/// A step, and the signals that it declares and reads.
struct Piece {
    step: Step,
    declares: Vec<SignalId>,
    reads: Vec<SignalId>,
}

impl Piece {
    fn new(step: Step, declares: impl Iterator<Item = SignalId>, reads: &BTreeSet<SignalId>) -> Self {
        Self { step, declares: declares.collect(), reads: reads.iter().copied().collect() }
    }
}

struct Ordering<'a> {
    pieces: &'a [Piece],
    resolved: &'a [Expression],
    /// The piece that declares each signal.
    sources: BTreeMap<SignalId, usize>,
    seen: BTreeSet<usize>,
    order: Vec<usize>,
}

impl Ordering<'_> {
    /// Adds a piece after those that it reads, and an instance after those before it. What an instance reads of one behind it flows back, as
    /// the readiness of a stream does: pieces for an instance take nothing of those behind `last`.
    fn add(&mut self, n: usize, last: usize) {
        let last = match self.pieces[n].step {
            Step::Part(part) if part > last => return,
            Step::Part(part) => part,
            Step::Process(_) => last,
        };
        if !self.seen.insert(n) {
            return;
        }
        if let Step::Part(part) = self.pieces[n].step {
            let is_before = |other: &Piece| matches!(other.step, Step::Part(other) if other < part);
            let before: Vec<usize> = (0..n).filter(|other| is_before(&self.pieces[*other])).collect();
            before.into_iter().for_each(|other| self.add(other, part));
        }
        for id in self.reads(n) {
            if let Some(source) = self.sources.get(&id) {
                self.add(*source, last);
            }
        }
        self.order.push(n);
    }

    /// All signals that a piece names.
    fn reads(&self, n: usize) -> Vec<SignalId> {
        let mut open: Vec<SignalId> = self.pieces[n].reads.iter().rev().copied().collect();
        let (mut known, mut reads) = (BTreeSet::new(), vec![]);
        while let Some(id) = open.pop() {
            if !known.insert(id) {
                continue;
            }
            reads.push(id);
            self.resolved[id].walk(&mut |part| {
                if let Node::Signal(id) = part.node {
                    open.push(id);
                }
            });
        }
        reads
    }

    fn finish(self) -> Order {
        let mut above = BTreeSet::new();
        let mut early = BTreeSet::new();
        for &n in &self.order {
            above.insert(n);
            let is_early = |id: &SignalId| self.sources.get(id).is_some_and(|source| !above.contains(source));
            early.extend(self.reads(n).into_iter().filter(is_early));
        }
        Order { steps: self.order.iter().map(|n| self.pieces[*n].step).collect(), early }
    }
}
