//! Which bits nothing reads. A linter asks about them, so the module says that it is meant.

use std::collections::BTreeMap;

use crate::expression::{Expression, Node};
use crate::scope::{Scope, SignalId};

/// The bits of each signal that something reads.
pub(crate) struct Read<'a> {
    scope: &'a Scope,
    /// What stands for each signal.
    resolved: &'a [Expression],
    bits: BTreeMap<SignalId, Vec<bool>>,
}

impl<'a> Read<'a> {
    pub fn nothing(scope: &'a Scope, resolved: &'a [Expression]) -> Self {
        Self { scope, resolved, bits: BTreeMap::new() }
    }

    /// Marks what an expression reads.
    pub fn expression(&mut self, expression: &Expression) {
        match &expression.node {
            Node::Signal(id) => self.signal(*id, 0, self.scope.signals[*id].ty.bits),
            Node::Slice(x, at) => match signal(x) {
                Some(id) => self.signal(id, *at, expression.ty.bits),
                None => self.expression(x),
            },
            Node::Bit(x, at) => match (signal(x), at.constant().and_then(|at| usize::try_from(at).ok())) {
                (Some(id), Some(at)) => self.signal(id, at, 1),
                _ => self.operands(expression),
            },
            _ => self.operands(expression),
        }
    }

    fn operands(&mut self, expression: &Expression) {
        expression.operands().into_iter().for_each(|operand| self.expression(operand));
    }

    fn signal(&mut self, id: SignalId, at: usize, bits: usize) {
        match &self.resolved[id].node {
            Node::Signal(end) => {
                let all = self.scope.signals[*end].ty.bits;
                let read = self.bits.entry(*end).or_insert_with(|| vec![false; all]);
                read.iter_mut().skip(at).take(bits).for_each(|bit| *bit = true);
            }
            _ => self.expression(&self.resolved[id].clone()),
        }
    }

    /// Whether some bits of the signal are read by nothing.
    pub fn is_partial(&self, id: SignalId) -> bool {
        self.bits.get(&id).is_none_or(|bits| bits.contains(&false))
    }
}

/// The signal that a part is taken from.
fn signal(x: &Expression) -> Option<SignalId> {
    match &x.node {
        Node::Signal(id) => Some(*id),
        Node::Reinterpret(x) => signal(x),
        _ => None,
    }
}
