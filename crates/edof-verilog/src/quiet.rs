//! No process wakes itself by way of others.
//!
//! A simulator runs a whole `always @*` when anything that it reads changes, and a target that is assigned twice changes for a moment in each run. A
//! process of several targets therefore looks to the simulator as if each followed everything that the process reads. Where this closes a
//! loop, here or in a module around, the simulator would never come to rest. There each target has a process of its own, with copies of the local
//! signals that it reads before their last assignment.

use std::collections::{BTreeMap, BTreeSet};

use crate::cycles::{Path, keep, loops, paths, signal_edges};
use crate::expression::{Expression, Node};
use crate::kernel::{Arm, Statement};
use crate::process::Process;
use crate::scope::{Role, Scope, Signal, SignalId};
use crate::settle::unsettled;

/// The processes, of which those that would wake themselves are cut. `through` lead through parts.
pub(crate) fn quieten(scope: &mut Scope, processes: Vec<Process>, through: &[Path]) -> Vec<Process> {
    let mut edges = signal_edges(scope, &processes);
    edges.extend(through);
    let before = sorted(paths(scope, &edges));
    let mut quiet = vec![];
    for process in processes {
        let with: Vec<Path> = edges.iter().copied().chain(wakes(&process)).collect();
        if process.targets.len() == 1 {
            quiet.push(process);
        } else if loops(scope.signals.len(), &with).is_empty() && sorted(paths(scope, &with)) == before {
            edges = with;
            quiet.push(process);
        } else {
            quiet.extend(apart(scope, &process));
        }
    }
    quiet
}

/// From everything that wakes a process to everything that a run of it may change.
pub(crate) fn wakes(process: &Process) -> Vec<Path> {
    let reads = process.reads.difference(&process.targets);
    reads.flat_map(|read| process.targets.iter().map(move |target| (*read, *target))).collect()
}

pub(crate) fn sorted(mut paths: Vec<Path>) -> Vec<Path> {
    paths.sort_unstable();
    paths
}

/// A process for each target.
fn apart(scope: &mut Scope, process: &Process) -> Vec<Process> {
    let seen = unsettled(scope, &process.statements);
    let mut processes = vec![];
    for target in &process.targets {
        let mut with = BTreeSet::from([*target]);
        let mut open = vec![*target];
        while let Some(id) = open.pop() {
            open.extend(seen.get(&id).into_iter().flatten().filter(|read| with.insert(**read)));
        }
        let statements = keep(&process.statements, &with);
        let copies: BTreeMap<SignalId, SignalId> =
            with.into_iter().filter(|id| id != target).map(|id| (id, copy(scope, id))).collect();
        processes.push(Process::of(renamed(statements, &copies), process.origin));
    }
    processes
}

/// A local signal of the same type.
fn copy(scope: &mut Scope, id: SignalId) -> SignalId {
    let Signal { key, ty, .. } = &scope.signals[id];
    let signal = Signal { key: format!("{key}$copy"), ty: *ty, role: Role::Local, is_clock: false };
    scope.signals.push(signal);
    scope.signals.len() - 1
}

fn renamed(statements: Vec<Statement>, names: &BTreeMap<SignalId, SignalId>) -> Vec<Statement> {
    let expression = |expression| reading(expression, names);
    let statement = |statement| match statement {
        Statement::Assign(mut assign) => {
            assign.target = names.get(&assign.target).copied().unwrap_or(assign.target);
            assign.value = expression(assign.value);
            Statement::Assign(assign)
        }
        Statement::If { test, then, otherwise } => Statement::If {
            test: expression(test),
            then: renamed(then, names),
            otherwise: renamed(otherwise, names),
        },
        Statement::Case { subject, arms, default } => Statement::Case {
            subject: expression(subject),
            arms: arms
                .into_iter()
                .map(|Arm { label, body }| Arm { label, body: renamed(body, names) })
                .collect(),
            default: default.map(|body| renamed(body, names)),
        },
        comment @ Statement::Comment(_) => comment,
    };
    statements.into_iter().map(statement).collect()
}

fn reading(expression: Expression, names: &BTreeMap<SignalId, SignalId>) -> Expression {
    let mut expression = expression.map(&mut |operand| reading(operand, names));
    if let Node::Signal(id) = &mut expression.node {
        *id = names.get(id).copied().unwrap_or(*id);
    }
    expression
}
