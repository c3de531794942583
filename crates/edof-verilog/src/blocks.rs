//! One `always @*` for what one block of the kernel says.
//!
//! A process for each target is never a loop where the circuit is none. Together they may look like one to a simulator that orders whole
//! blocks, across modules too. So processes of one block of the kernel are joined only where no output of the module, and no signal in it, thereby
//! follows a signal that it did not follow before.

use std::collections::BTreeSet;

use crate::cycles::{Path, keep, loops, paths};
use crate::expression::Node;
use crate::process::{Origin, Process};
use crate::quiet::{sorted, wakes};
use crate::scope::{Scope, SignalId};
use crate::simplify::without_dead;

/// The processes, joined. `blocks` are the whole blocks of the kernel, `edges` lead from every signal to those that follow it directly.
pub(crate) fn join(
    scope: &Scope,
    processes: Vec<Process>,
    blocks: &[Process],
    edges: &[Path],
) -> Vec<Process> {
    let together = processes.iter().filter(|process| process.is_combinational() && process.targets.len() > 1);
    let edges: Vec<Path> = edges.iter().copied().chain(together.flat_map(wakes)).collect();
    let mut joining = Joining { scope, paths: sorted(paths(scope, &edges)), edges };
    let mut joined: Vec<Process> = vec![];
    for process in processes {
        let block = blocks.iter().find(|block| block.origin == process.origin);
        // What has copies of signals stays as it is.
        let is_part =
            |process: &Process| block.is_some_and(|block| process.targets.is_subset(&block.targets));
        let candidate = joined.iter().position(|other| {
            let same = other.origin == process.origin && other.is_combinational();
            let parts = is_part(other) && is_part(&process);
            same && parts
                && is_choice(other)
                && is_choice(&process)
                && (is_block(other) || is_block(&process))
        });
        match (candidate, block) {
            (Some(at), Some(block)) => match joining.join(&joined[at], &process, block) {
                Some(both) => joined[at] = both,
                None => joined.push(process),
            },
            _ => joined.push(process),
        }
    }
    joined
}

fn is_block(process: &Process) -> bool {
    process.plain().is_none()
}

/// Whether the process says what is when: more than an assignment.
fn is_choice(process: &Process) -> bool {
    process.plain().is_none_or(|assign| matches!(assign.value.node, Node::Choose(..)))
}

struct Joining<'a> {
    scope: &'a Scope,
    paths: Vec<Path>,
    edges: Vec<Path>,
}

impl Joining<'_> {
    fn join(&mut self, one: &Process, other: &Process, block: &Process) -> Option<Process> {
        let targets: BTreeSet<SignalId> = &one.targets | &other.targets;
        let mut statements = keep(&block.statements, &targets);
        for target in &targets {
            statements = without_dead(statements, *target);
        }
        let both = Process::of(statements, Origin::Block(0));
        let both = Process { origin: one.origin, ..both };
        let edges: Vec<Path> = self.edges.iter().copied().chain(wakes(&both)).collect();
        let adds_none = loops(self.scope.signals.len(), &edges).is_empty()
            && sorted(paths(self.scope, &edges)) == self.paths;
        adds_none.then(|| {
            self.edges = edges;
            both
        })
    }
}
