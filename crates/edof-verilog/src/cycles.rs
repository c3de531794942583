//! Dependencies within a cycle: rejects loops without a register, and gives each target a process of its own.
//!
//! A block that drives a part's input and reads that part's output in one `always @*` is no loop if the two have nothing to
//! do with each other, but a simulator that orders whole processes sees one, across modules too, and may never come to rest.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::{EmitError, Fault, rust_path};
use crate::expression::{Expression, Node};
use crate::kernel::{Arm, Statement};
use crate::process::{Process, in_order};
use crate::scope::{Role, Scope, SignalId};
use crate::settle::unsettled;

/// From an input of a part to an output of it that follows it within the cycle.
pub(crate) type Path = (SignalId, SignalId);

/// What each target of a process follows from.
pub(crate) type Sources = BTreeMap<SignalId, BTreeSet<SignalId>>;

/// One process for each target; rejects loops of signals. `paths` lead through parts.
pub(crate) fn cut(scope: &Scope, processes: Vec<Process>, paths: &[Path]) -> Result<Vec<Process>, EmitError> {
    let count = scope.signals.len();
    let cut: Vec<Process> = processes.into_iter().flat_map(|process| by_target(scope, process)).collect();
    let edges: Vec<Path> = signal_edges(scope, &cut).into_iter().chain(paths.iter().copied()).collect();
    let looping = loops(count, &edges);
    let Some(first) = looping.first() else { return Ok(cut) };
    let around = looping.iter().map(|id| rust_path(&scope.signals[*id].key)).collect::<Vec<_>>().join(", ");
    Err(EmitError::field(&scope.path, &scope.signals[*first].key, Fault::Cycle(around)))
}

/// Which outputs of the block follow which of its inputs within a cycle; `edges` are those of its signals and parts.
pub(crate) fn paths(scope: &Scope, edges: &[Path]) -> Vec<Path> {
    let mut follows: Vec<Vec<SignalId>> = vec![vec![]; scope.signals.len()];
    edges.iter().for_each(|(from, to)| follows[*from].push(*to));
    let mut paths = vec![];
    for input in (0..scope.signals.len()).filter(|id| scope.signals[*id].role == Role::Input) {
        let (mut seen, mut open) = (BTreeSet::new(), vec![input]);
        while let Some(id) = open.pop() {
            if seen.insert(id) {
                open.extend(&follows[id]);
            }
        }
        let outputs = seen.into_iter().filter(|id| scope.signals[*id].role == Role::Output);
        paths.extend(outputs.map(|output| (input, output)));
    }
    paths
}

/// From every signal to those that follow it directly.
pub(crate) fn signal_edges(scope: &Scope, processes: &[Process]) -> Vec<Path> {
    let of_process = |process: &Process| {
        let sources = sources(scope, process);
        let edges =
            sources.into_iter().flat_map(|(target, from)| from.into_iter().map(move |read| (read, target)));
        edges.collect::<Vec<_>>()
    };
    processes.iter().flat_map(of_process).collect()
}

/// What each target follows from, local signals of the process looked through.
fn sources(scope: &Scope, process: &Process) -> Sources {
    let mut sources = Sources::new();
    collect(&process.statements, &BTreeSet::new(), &mut sources);
    let inner = |id: &SignalId| process.targets.contains(id) && in_order(scope, *id);
    let through = |target: SignalId| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![target]);
        while let Some(id) = open.pop() {
            for read in sources.get(&id).into_iter().flatten().filter(|_| id == target || inner(&id)) {
                if seen.insert(*read) {
                    open.push(*read);
                }
            }
        }
        seen.into_iter().filter(|id| !inner(id)).collect()
    };
    process.targets.iter().map(|target| (*target, through(*target))).collect()
}

pub(crate) fn collect(statements: &[Statement], above: &BTreeSet<SignalId>, sources: &mut Sources) {
    let with = |expression: &Expression| {
        let mut reads = above.clone();
        expression.walk(&mut |part| {
            if let Node::Signal(id) = part.node {
                reads.insert(id);
            }
        });
        reads
    };
    for statement in statements {
        match statement {
            Statement::Comment(_) => {}
            Statement::Assign(assign) => {
                sources.entry(assign.target).or_default().extend(with(&assign.value))
            }
            Statement::If { test, then, otherwise } => {
                let above = with(test);
                [then, otherwise].iter().for_each(|block| collect(block, &above, sources));
            }
            Statement::Case { subject, arms, default } => {
                let above = with(subject);
                let bodies = arms.iter().map(|arm| &arm.body).chain(default);
                bodies.for_each(|block| collect(block, &above, sources));
            }
        }
    }
}

/// The nodes that are on a loop or between two.
pub(crate) fn loops(count: usize, edges: &[Path]) -> BTreeSet<usize> {
    let backward: Vec<Path> = edges.iter().map(|(from, to)| (*to, *from)).collect();
    let ahead = peel(count, edges, &vec![true; count]);
    let both = peel(count, &backward, &ahead);
    (0..count).filter(|node| both[*node]).collect()
}

/// What is left when nodes that nothing leads to are taken away again and again.
fn peel(count: usize, edges: &[Path], present: &[bool]) -> Vec<bool> {
    let mut left = present.to_vec();
    let mut inward = vec![0; count];
    let mut follows: Vec<Vec<usize>> = vec![vec![]; count];
    for (from, to) in edges.iter().filter(|(from, to)| present[*from] && present[*to]) {
        inward[*to] += 1;
        follows[*from].push(*to);
    }
    let mut open: Vec<usize> = (0..count).filter(|node| left[*node] && inward[*node] == 0).collect();
    while let Some(node) = open.pop() {
        left[node] = false;
        for next in &follows[node] {
            inward[*next] -= 1;
            if inward[*next] == 0 {
                open.push(*next);
            }
        }
    }
    left
}

/// One process for each target, except that a signal that is read before its last assignment stays with what reads it.
fn by_target(scope: &Scope, process: Process) -> Vec<Process> {
    let together = unsettled(scope, &process.statements);
    let mut sets: Vec<BTreeSet<SignalId>> = vec![];
    for target in &process.targets {
        let mut set = together.get(target).cloned().unwrap_or_default();
        set.insert(*target);
        let (touching, apart): (Vec<_>, Vec<_>) =
            sets.into_iter().partition(|other| !other.is_disjoint(&set));
        sets = apart;
        sets.push(touching.into_iter().fold(set, |one, other| &one | &other));
    }
    if sets.len() == 1 {
        return vec![process];
    }
    sets.sort();
    sets.iter().map(|set| Process::of(keep(&process.statements, set), process.origin)).collect()
}

/// The statements that drive these targets.
pub(crate) fn keep(statements: &[Statement], targets: &BTreeSet<SignalId>) -> Vec<Statement> {
    let mut kept = vec![];
    let mut comment = None;
    for statement in statements {
        let before = kept.len();
        match statement {
            Statement::Comment(_) => comment = Some(statement),
            Statement::Assign(assign) if targets.contains(&assign.target) => kept.push(statement.clone()),
            Statement::Assign(_) => {}
            Statement::If { test, then, otherwise } => {
                kept.extend(condition(test, keep(then, targets), keep(otherwise, targets)));
            }
            Statement::Case { subject, arms, default } => {
                let arms: Vec<Arm> = arms
                    .iter()
                    .map(|arm| Arm { label: arm.label.clone(), body: keep(&arm.body, targets) })
                    .collect();
                let default = default.as_ref().map(|body| keep(body, targets));
                let empty = arms.iter().map(|arm| &arm.body).chain(&default).all(Vec::is_empty);
                if !empty {
                    kept.push(Statement::Case { subject: subject.clone(), arms, default });
                }
            }
        }
        if kept.len() > before
            && let Some(comment) = comment.take()
        {
            kept.insert(before, comment.clone());
        }
    }
    kept
}

/// A condition of which only one side is left is turned so that this comes first, and joined with one that stands alone in it.
fn condition(test: &Expression, then: Vec<Statement>, otherwise: Vec<Statement>) -> Option<Statement> {
    if !then.is_empty() {
        return Some(Statement::If { test: test.clone(), then, otherwise });
    }
    let not = Expression::new(test.ty, Node::Not(Box::new(test.clone())));
    match <[Statement; 1]>::try_from(otherwise) {
        Ok([Statement::If { test: also, then, otherwise }]) if otherwise.is_empty() => {
            let test = Expression::new(test.ty, Node::Logical("&&", Box::new(not), Box::new(also)));
            Some(Statement::If { test, then, otherwise })
        }
        Ok(one) => Some(Statement::If { test: not, then: one.into(), otherwise: vec![] }),
        Err(none) if none.is_empty() => None,
        Err(otherwise) => Some(Statement::If { test: not, then: otherwise, otherwise: vec![] }),
    }
}
