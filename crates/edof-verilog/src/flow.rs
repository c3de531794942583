//! Holds a kernel to what Verilog can say the same way: no latch, nothing read before it is written, nothing left open.

use std::collections::{HashMap, HashSet};

use crate::error::{EmitError, Fault};
use crate::expression::{Expression, Node};
use crate::kernel::{Assign, Statement};
use crate::scope::{Role, Scope, SignalId};

/// Which bits of which signals are driven on every path so far.
type Driven = HashMap<SignalId, Vec<bool>>;

/// Rejects latches, reads before writes, and signals that nothing drives.
pub(crate) fn check(scope: &Scope, statements: &[Statement]) -> Result<(), EmitError> {
    let mut targets = HashSet::new();
    collect_targets(statements, &mut targets);
    let mut flow = Flow { scope, targets, driven: Driven::new() };
    flow.block(statements)?;
    for (id, signal) in scope.signals.iter().enumerate() {
        let fault = match signal.role {
            Role::Input | Role::Constant(_) | Role::Register | Role::PartOutput => continue,
            Role::Local if !flow.targets.contains(&id) => continue,
            _ if !flow.targets.contains(&id) => Fault::Undriven,
            _ if !flow.is_driven(id) => Fault::Latch,
            _ => continue,
        };
        return Err(EmitError::field(&scope.path, &signal.key, fault));
    }
    Ok(())
}

/// The signals that the statements drive, on any path.
pub(crate) fn collect_targets(statements: &[Statement], targets: &mut HashSet<SignalId>) {
    for statement in statements {
        match statement {
            Statement::Comment(_) => {}
            Statement::Assign(assign) => {
                targets.insert(assign.target);
            }
            Statement::If { then, otherwise, .. } => {
                [then, otherwise].iter().for_each(|block| collect_targets(block, targets));
            }
            Statement::Case { arms, default, .. } => {
                arms.iter()
                    .map(|arm| &arm.body)
                    .chain(default)
                    .for_each(|block| collect_targets(block, targets));
            }
        }
    }
}

struct Flow<'a> {
    scope: &'a Scope,
    targets: HashSet<SignalId>,
    driven: Driven,
}

impl Flow<'_> {
    fn is_driven(&self, id: SignalId) -> bool {
        self.driven.get(&id).is_some_and(|bits| bits.iter().all(|bit| *bit))
    }

    fn block(&mut self, statements: &[Statement]) -> Result<(), EmitError> {
        statements.iter().try_for_each(|statement| self.statement(statement))
    }

    fn statement(&mut self, statement: &Statement) -> Result<(), EmitError> {
        match statement {
            Statement::Comment(_) => Ok(()),
            Statement::Assign(assign) => self.assign(assign),
            Statement::If { test, then, otherwise } => {
                self.read(test, "")?;
                self.branches(&[then, otherwise])
            }
            Statement::Case { subject, arms, default } => {
                self.read(subject, "")?;
                let nothing = vec![];
                let mut bodies: Vec<&Vec<Statement>> = arms.iter().map(|arm| &arm.body).collect();
                bodies.push(default.as_ref().unwrap_or(&nothing));
                self.branches(&bodies)
            }
        }
    }

    fn assign(&mut self, assign: &Assign) -> Result<(), EmitError> {
        let signal = &self.scope.signals[assign.target];
        self.read(&assign.value, &signal.key)?;
        let bits = self.driven.entry(assign.target).or_insert_with(|| vec![false; signal.ty.bits]);
        let at = assign.at.unwrap_or(0);
        bits[at..at + assign.value.ty.bits].fill(true);
        Ok(())
    }

    /// Only what every branch drives is driven after them.
    fn branches(&mut self, bodies: &[&Vec<Statement>]) -> Result<(), EmitError> {
        let before = self.driven.clone();
        let mut after: Option<Driven> = None;
        for body in bodies {
            self.driven.clone_from(&before);
            self.block(body)?;
            let this = std::mem::take(&mut self.driven);
            after = Some(match after {
                Some(other) => both(other, &this),
                None => this,
            });
        }
        self.driven = after.unwrap_or(before);
        Ok(())
    }

    /// Rust reads these as they stand at this point of the kernel; so they must have a value.
    fn read(&self, expression: &Expression, field: &str) -> Result<(), EmitError> {
        let mut found = Ok(());
        expression.walk(&mut |part| {
            if let Node::Signal(id) = part.node {
                let signal = &self.scope.signals[id];
                let in_order = matches!(signal.role, Role::Output | Role::Local);
                if in_order && !self.is_driven(id) && found.is_ok() {
                    found = Err(match self.targets.contains(&id) {
                        true => (field, Fault::ReadBeforeWrite(crate::error::rust_path(&signal.key))),
                        false => (signal.key.as_str(), Fault::Undriven),
                    });
                }
            }
        });
        found.map_err(|(field, fault)| EmitError::field(&self.scope.path, field, fault))
    }
}

fn both(mut one: Driven, other: &Driven) -> Driven {
    one.retain(|id, _| other.contains_key(id));
    for (id, bits) in &mut one {
        bits.iter_mut().zip(&other[id]).for_each(|(bit, too)| *bit &= too);
    }
    one
}
