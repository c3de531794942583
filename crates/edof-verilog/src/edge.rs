//! Registers that a clocked block assigns as the kernel does, without a signal for their next value.

use std::collections::BTreeSet;

use crate::cycles::keep;
use crate::expression::Node;
use crate::kernel::{Assign, Statement};
use crate::process::{Origin, Process};
use crate::scope::{Role, Scope, SignalId};
use crate::settle::unsettled;
use crate::simplify::without_dead;

/// The statements without those registers, and what these take, in the order of the kernel.
///
/// A register whose next value the kernel reads, or that follows a signal which is assigned once more later, keeps its `_d`.
pub(crate) fn split(scope: &Scope, statements: &[Statement]) -> (Vec<Statement>, Option<Process>) {
    let everything = Process::of(statements.to_vec(), Origin::Edge);
    let unsettled = unsettled(scope, statements);
    let is_direct = |id: &SignalId| {
        scope.signals[*id].role == Role::Next && !everything.reads.contains(id) && !unsettled.contains_key(id)
    };
    let direct: BTreeSet<SignalId> = everything.targets.iter().copied().filter(is_direct).collect();
    if direct.is_empty() {
        return (statements.to_vec(), None);
    }
    let others: BTreeSet<SignalId> = everything.targets.difference(&direct).copied().collect();
    let mut edge = without_holds(scope, keep(statements, &direct));
    for target in &direct {
        edge = without_dead(edge, *target);
    }
    (keep(statements, &others), Some(Process::of(edge, Origin::Edge)))
}

/// A register holds by itself: leaves out assignments that say so first.
fn without_holds(scope: &Scope, statements: Vec<Statement>) -> Vec<Statement> {
    let mut written = BTreeSet::new();
    let is_hold = |assign: &Assign| {
        let own = scope.registers.iter().find(|register| register.next == assign.target);
        own.is_some_and(|register| matches!(assign.value.node, Node::Signal(id) if id == register.value))
    };
    let mut kept = vec![];
    for statement in statements {
        if let Statement::Assign(assign) = &statement
            && is_hold(assign)
            && !written.contains(&assign.target)
        {
            continue;
        }
        written.extend(Process::of(vec![statement.clone()], Origin::Edge).targets);
        kept.push(statement);
    }
    kept
}
