//! What of a kernel matters: a module has no input that it does not read, and no wire that leads nowhere.

use std::collections::BTreeSet;

use crate::cycles::{Sources, collect, keep};
use crate::process::Process;
use crate::scope::{Role, Scope, SignalId};

/// The processes that an output, a register or a part depends on, and every signal that one of these does. `dropped` are inputs of parts
/// that the part's module has not.
pub(crate) fn prune(
    scope: &Scope,
    processes: Vec<Process>,
    dropped: &BTreeSet<SignalId>,
) -> (Vec<Process>, BTreeSet<SignalId>) {
    let mut sources = Sources::new();
    processes.iter().for_each(|process| collect(&process.statements, &BTreeSet::new(), &mut sources));
    let matters = |id: &SignalId| match scope.signals[*id].role {
        Role::Output | Role::Next | Role::Clock => true,
        Role::PartInput => !dropped.contains(id),
        _ => false,
    };
    let mut open: Vec<SignalId> = (0..scope.signals.len()).filter(matters).collect();
    let mut live = BTreeSet::new();
    while let Some(id) = open.pop() {
        if live.insert(id) {
            open.extend(sources.get(&id).into_iter().flatten());
        }
    }
    let kept = processes.into_iter().filter_map(|process| {
        let targets: BTreeSet<SignalId> = process.targets.intersection(&live).copied().collect();
        match targets.len() {
            0 => None,
            n if n == process.targets.len() => Some(process),
            _ => Some(Process::of(keep(&process.statements, &targets), process.origin)),
        }
    });
    (kept.collect(), live)
}
