//! Assignments that declare the signal they drive, and the order that this asks for.

use std::collections::{BTreeMap, BTreeSet};

use crate::expression::{Expression, Node};
use crate::process::Process;
use crate::scope::{Role, Scope, SignalId};

/// The signal that an assignment declares, `wire x = …;`: a local one, or what only instances read, which stand behind. `reads` is what the
/// kernel reads.
pub(crate) fn declares(scope: &Scope, process: &Process, reads: &BTreeSet<SignalId>) -> Option<SignalId> {
    let target = process.plain().filter(|_| process.is_combinational())?.target;
    let is_declared = match scope.signals[target].role {
        Role::Local => true,
        Role::PartInput => !reads.contains(&target),
        _ => false,
    };
    is_declared.then_some(target)
}

/// The processes in the order of the kernel, each after those that declare what it reads; `resolved` is what stands for each signal.
pub(crate) fn order(
    scope: &Scope,
    processes: Vec<Process>,
    resolved: &[Expression],
    reads: &BTreeSet<SignalId>,
) -> Vec<Process> {
    let declared = processes.iter().enumerate();
    let declared = declared.filter_map(|(n, process)| Some((declares(scope, process, reads)?, n))).collect();
    let mut ordering =
        Ordering { processes: &processes, resolved, declared, seen: BTreeSet::new(), order: vec![] };
    (0..processes.len()).for_each(|n| ordering.add(n));
    let order = ordering.order;
    let mut processes: Vec<Option<Process>> = processes.into_iter().map(Some).collect();
    order.into_iter().filter_map(|n| processes[n].take()).collect()
}

struct Ordering<'a> {
    processes: &'a [Process],
    resolved: &'a [Expression],
    /// The process that declares each signal.
    declared: BTreeMap<SignalId, usize>,
    seen: BTreeSet<usize>,
    order: Vec<usize>,
}

impl Ordering<'_> {
    fn add(&mut self, n: usize) {
        if !self.seen.insert(n) {
            return;
        }
        let mut open: Vec<SignalId> = self.processes[n].reads.iter().rev().copied().collect();
        let mut known = BTreeSet::new();
        while let Some(id) = open.pop() {
            if !known.insert(id) {
                continue;
            }
            if let Some(source) = self.declared.get(&id) {
                self.add(*source);
            }
            self.resolved[id].walk(&mut |part| {
                if let Node::Signal(id) = part.node {
                    open.push(id);
                }
            });
        }
        self.order.push(n);
    }
}
