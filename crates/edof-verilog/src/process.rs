//! Cuts a kernel into processes that do not depend on each other's order: plain assignments and `always @*` blocks.
//!
//! Statements that drive the same signal stay together and in order. So do a read of a local signal or output and the
//! writes that follow it, because Rust reads those as they stand. Everything else means the same in any order.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::error::{EmitError, Fault, rust_path};
use crate::expression::{Expression, Node};
use crate::flow::collect_targets;
use crate::kernel::{Assign, Statement};
use crate::scope::{Role, Scope, SignalId};

/// Statements that run together.
#[derive(Debug, Clone)]
pub(crate) struct Process {
    pub statements: Vec<Statement>,
    pub targets: BTreeSet<SignalId>,
    pub reads: BTreeSet<SignalId>,
    pub origin: Origin,
}

/// Where the statements of a process come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A block of the kernel, by its number.
    Block(usize),
    /// What registers take at their clock's edge.
    Edge,
}

impl Process {
    pub fn of(statements: Vec<Statement>, origin: Origin) -> Self {
        let (mut targets, mut reads) = (HashSet::new(), BTreeSet::new());
        collect_targets(&statements, &mut targets);
        collect_reads(&statements, &mut reads);
        Self { statements, targets: targets.into_iter().collect(), reads, origin }
    }

    /// Whether an `assign` or an `always @*` block is meant.
    pub fn is_combinational(&self) -> bool {
        self.origin != Origin::Edge
    }

    /// Calls `visit` with everything that the process computes.
    pub fn expressions<'a>(&'a self, visit: &mut dyn FnMut(&'a Expression)) {
        each(&self.statements, visit);
    }

    /// The assignment that the process is, where it is one of a whole signal.
    pub fn plain(&self) -> Option<&Assign> {
        let mut real = self.statements.iter().filter(|statement| !matches!(statement, Statement::Comment(_)));
        match (real.next(), real.next()) {
            (Some(Statement::Assign(assign)), None) if assign.at.is_none() => Some(assign),
            _ => None,
        }
    }
}

/// The processes of a kernel, in the order in which its text comes to them.
pub(crate) fn split(scope: &Scope, statements: Vec<Statement>) -> Result<Vec<Process>, EmitError> {
    let unit = |(number, statements)| Process::of(statements, Origin::Block(number));
    let mut units: Vec<Process> = units(statements).into_iter().enumerate().map(unit).collect();
    drop_dead_holds(&mut units);
    let groups = group(scope, &units);
    check_settled_reads(scope, &units, &groups)?;
    // The place of a process is its first statement that says more than that a register holds.
    let mut places = vec![usize::MAX; units.len()];
    for (unit, process) in units.iter().enumerate() {
        let place = if holds(process) { units.len() + unit } else { unit };
        places[groups[unit]] = places[groups[unit]].min(place);
    }
    let mut order: Vec<usize> = (0..units.len()).collect();
    order.sort_by_key(|unit| (places[groups[*unit]], *unit));
    let mut processes: Vec<(usize, Vec<Statement>)> = vec![];
    let mut units: Vec<Option<Process>> = units.into_iter().map(Some).collect();
    for unit in order {
        let statements = units[unit].take().map(|process| process.statements).unwrap_or_default();
        match processes.last_mut() {
            Some((group, together)) if *group == groups[unit] => together.extend(statements),
            _ => processes.push((groups[unit], statements)),
        }
    }
    let process = |(group, statements)| Process::of(statements, Origin::Block(group));
    Ok(processes.into_iter().map(process).collect())
}

/// Top-level statements, each with the comments before it.
fn units(statements: Vec<Statement>) -> Vec<Vec<Statement>> {
    let mut units = vec![];
    let mut unit = vec![];
    for statement in statements {
        let is_comment = matches!(statement, Statement::Comment(_));
        unit.push(statement);
        if !is_comment {
            units.push(std::mem::take(&mut unit));
        }
    }
    units
}

fn holds(process: &Process) -> bool {
    process.plain().is_some_and(|assign| assign.holds)
}

/// A register that is driven anyhow need not hold first.
fn drop_dead_holds(units: &mut Vec<Process>) {
    let mut driven = BTreeSet::new();
    let mut kept: Vec<Process> = vec![];
    for unit in units.drain(..).rev() {
        match unit.plain() {
            Some(assign) if assign.holds && driven.contains(&assign.target) => continue,
            Some(assign) => _ = driven.insert(assign.target),
            None => {}
        }
        kept.push(unit);
    }
    kept.reverse();
    *units = kept;
}

/// The group of each unit.
fn group(scope: &Scope, units: &[Process]) -> Vec<usize> {
    let mut groups: Vec<usize> = (0..units.len()).collect();
    let mut writers: Vec<Vec<usize>> = vec![vec![]; scope.signals.len()];
    for (unit, process) in units.iter().enumerate() {
        process.targets.iter().for_each(|target| writers[*target].push(unit));
    }
    for together in &writers {
        together.windows(2).for_each(|pair| join(&mut groups, pair[0], pair[1]));
    }
    for (unit, process) in units.iter().enumerate() {
        for read in process.reads.iter().filter(|read| in_order(scope, **read)) {
            let later = writers[*read].iter().copied().filter(|writer| *writer > unit);
            later.for_each(|writer| join(&mut groups, unit, writer));
        }
    }
    (0..units.len()).map(|unit| root(&groups, unit)).collect()
}

/// Signals that Rust reads as they stand, not as they settle.
pub(crate) fn in_order(scope: &Scope, id: SignalId) -> bool {
    matches!(scope.signals[id].role, Role::Output | Role::Local)
}

fn root(groups: &[usize], mut unit: usize) -> usize {
    while groups[unit] != unit {
        unit = groups[unit];
    }
    unit
}

fn join(groups: &mut [usize], one: usize, other: usize) {
    let (one, other) = (root(groups, one), root(groups, other));
    groups[one.max(other)] = one.min(other);
}

/// Rust reads the inputs of parts and registers as they settle. Inside the process that drives them, that is their value
/// only after the last write.
fn check_settled_reads(scope: &Scope, units: &[Process], groups: &[usize]) -> Result<(), EmitError> {
    let mut last_write = HashMap::new();
    for (unit, process) in units.iter().enumerate() {
        process.targets.iter().for_each(|target| _ = last_write.insert((groups[unit], *target), unit));
    }
    for (unit, process) in units.iter().enumerate() {
        for read in process.reads.iter().filter(|read| !in_order(scope, **read)) {
            if last_write.get(&(groups[unit], *read)).is_some_and(|last| *last >= unit) {
                let key = &scope.signals[*read].key;
                return Err(EmitError::field(&scope.path, key, Fault::ReadBeforeWrite(rust_path(key))));
            }
        }
    }
    Ok(())
}

fn each<'a>(statements: &'a [Statement], visit: &mut dyn FnMut(&'a Expression)) {
    for statement in statements {
        match statement {
            Statement::Comment(_) => {}
            Statement::Assign(assign) => visit(&assign.value),
            Statement::If { test, then, otherwise } => {
                visit(test);
                [then, otherwise].into_iter().for_each(|block| each(block, visit));
            }
            Statement::Case { subject, arms, default } => {
                visit(subject);
                arms.iter().map(|arm| &arm.body).chain(default).for_each(|block| each(block, visit));
            }
        }
    }
}

fn collect_reads(statements: &[Statement], reads: &mut BTreeSet<SignalId>) {
    each(statements, &mut |expression| collect(expression, reads));
}

fn collect(expression: &Expression, reads: &mut BTreeSet<SignalId>) {
    expression.walk(&mut |part| {
        if let Node::Signal(id) = part.node {
            reads.insert(id);
        }
    });
}
