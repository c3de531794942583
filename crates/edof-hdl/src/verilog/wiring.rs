//! Which signals need no wire of their own, because a plain assignment makes them another name of a signal or constant.

use std::collections::{BTreeMap, BTreeSet};

use super::error::{EmitError, Fault, rust_path};
use super::expression::{Expression, Node};
use super::process::Process;
use super::scope::{Role, Scope, SignalId};

/// For a signal, the signal, literal or state that stands for it.
#[derive(Debug, Default)]
pub(super) struct Wiring {
    stands_for: BTreeMap<SignalId, Expression>,
}

impl Wiring {
    /// Finds the direct connections and drops the processes that made them. Signals of `own` keep wires of their own; `reads` are the
    /// signals that the kernel reads.
    pub fn find(
        scope: &Scope,
        processes: &mut Vec<Process>,
        own: &BTreeSet<SignalId>,
        reads: &BTreeSet<SignalId>,
    ) -> Result<Self, EmitError> {
        let mut wiring = Self::default();
        processes.retain(|process| !wiring.connect(scope, process, own, reads));
        for register in &scope.registers {
            if !matches!(wiring.resolve(scope, register.clock)?.node, Node::Signal(id) if id != register.clock)
            {
                let key = &scope.signals[register.clock].key;
                return Err(EmitError::field(&scope.path, key, Fault::Clock));
            }
        }
        Ok(wiring)
    }

    fn connect(
        &mut self,
        scope: &Scope,
        process: &Process,
        own: &BTreeSet<SignalId>,
        reads: &BTreeSet<SignalId>,
    ) -> bool {
        let Some(assign) = process.plain() else { return false };
        let is_atom = matches!(assign.value.node, Node::Signal(_) | Node::Literal(_) | Node::State(_));
        let is_slice = is_slice(scope, &assign.value) && !reads.contains(&assign.target);
        let (signal, stands_for) = match (&scope.signals[assign.target].role, &assign.value.node) {
            (Role::PartInput | Role::Next | Role::Clock, _) if is_atom => {
                (assign.target, assign.value.clone())
            }
            (Role::PartInput, _) if is_slice => (assign.target, assign.value.clone()),
            (Role::Output, Node::Signal(from))
                if scope.signals[*from].role == Role::PartOutput && !own.contains(from) =>
            {
                (*from, Expression::signal(scope, assign.target))
            }
            _ => return false,
        };
        let is_free = !self.stands_for.contains_key(&signal);
        if is_free {
            self.stands_for.insert(signal, stands_for);
        }
        is_free
    }

    /// Whether something else stands for the signal.
    pub fn is_replaced(&self, id: SignalId) -> bool {
        self.stands_for.contains_key(&id)
    }

    /// What stands for a signal in the end.
    pub fn resolve(&self, scope: &Scope, id: SignalId) -> Result<Expression, EmitError> {
        let mut expression = Expression::signal(scope, id);
        for _ in 0..=self.stands_for.len() {
            match expression.node {
                Node::Signal(at) if self.is_replaced(at) => expression = self.stands_for[&at].clone(),
                _ => return Ok(expression),
            }
        }
        let key = &scope.signals[id].key;
        Err(EmitError::field(&scope.path, key, Fault::Cycle(rust_path(key))))
    }
}

/// Bits of a signal, which a pin can take as they are.
fn is_slice(scope: &Scope, value: &Expression) -> bool {
    let is_signal = |x: &Expression| {
        matches!(x.node, Node::Signal(id)
            if scope.signals[id].ty.bits > 1 && !matches!(scope.signals[id].role, Role::Constant(_)))
    };
    match &value.node {
        Node::Slice(x, _) => is_signal(x),
        Node::Bit(x, at) => is_signal(x) && at.constant().is_some(),
        _ => false,
    }
}
