//! Which signals need no wire of their own: a plain assignment makes them another name of a signal or constant, or a register takes them.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::{EmitError, Fault, rust_path};
use crate::expression::{Expression, Node};
use crate::print::pieces;
use crate::process::Process;
use crate::scope::{Role, Scope, SignalId};

/// Signals that a concatenation at a pin has at most.
const PIECES: usize = 3;

/// For a signal, what stands for it.
#[derive(Debug, Default)]
pub(crate) struct Wiring {
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
        // A block that hangs on constants alone would never start.
        let is_block = |process: &&Process| process.plain().is_none() && process.is_combinational();
        let blocks = processes.iter().filter(is_block);
        let started: BTreeSet<SignalId> = blocks.flat_map(|process| process.reads.iter().copied()).collect();
        processes.retain(|process| !wiring.connect(scope, process, reads, &started));
        processes.retain(|process| !wiring.connect_output(scope, process, own));
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
        reads: &BTreeSet<SignalId>,
        started: &BTreeSet<SignalId>,
    ) -> bool {
        let Some(assign) = process.plain().filter(|_| process.is_combinational()) else { return false };
        let value = whole(&assign.value);
        let is_atom = matches!(value.node, Node::Signal(_) | Node::Literal(_) | Node::State(_));
        let is_unread = !reads.contains(&assign.target);
        let stands = match &scope.signals[assign.target].role {
            Role::PartInput => {
                is_atom || (is_unread && (is_slice(scope, value) || is_for_pin(scope, assign.target, value)))
            }
            // What a register takes stands where it takes it.
            Role::Next => is_atom || is_unread,
            Role::Clock => is_atom,
            Role::Local => is_atom && (is_wire(scope, value) || !started.contains(&assign.target)),
            _ => false,
        };
        stands && self.replace(assign.target, value.clone())
    }

    /// An output of a part that is an output of the block.
    fn connect_output(&mut self, scope: &Scope, process: &Process, own: &BTreeSet<SignalId>) -> bool {
        let Some(assign) = process.plain().filter(|_| process.is_combinational()) else { return false };
        let Node::Signal(from) = whole(&assign.value).node else { return false };
        let Ok(Node::Signal(from)) = self.resolve(scope, from).map(|value| value.node) else { return false };
        let is_output = scope.signals[assign.target].role == Role::Output;
        let is_parts = scope.signals[from].role == Role::PartOutput && !own.contains(&from);
        is_output && is_parts && self.replace(from, Expression::signal(scope, assign.target))
    }

    fn replace(&mut self, signal: SignalId, by: Expression) -> bool {
        let is_free = !self.stands_for.contains_key(&signal);
        if is_free {
            self.stands_for.insert(signal, by);
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

/// Conditions of two signals, and signals side by side, that stand at a pin by themselves; those of arrays are for a loop to see.
fn is_for_pin(scope: &Scope, pin: SignalId, value: &Expression) -> bool {
    let is_in_array =
        scope.signals[pin].key.split('$').nth(1).is_some_and(|part| part.parse::<usize>().is_ok());
    let is_plain = |x: &Expression| matches!(x.node, Node::Signal(_)) || is_slice(scope, x);
    let is_term = |x: &Expression| match &x.node {
        Node::Not(x) => is_plain(x),
        _ => is_plain(x),
    };
    let is_condition = match &value.node {
        Node::Logical(_, x, y) => is_term(x) && is_term(y),
        Node::Not(_) => is_term(value),
        _ => false,
    };
    let is_wide =
        |x: &Expression| matches!(x.node, Node::Signal(_)) && is_wire(scope, x) || is_slice(scope, x);
    let is_concatenation = match &value.node {
        Node::Resize(x) => !x.ty.signed && is_wide(x),
        _ => pieces(value).is_some_and(|pieces| pieces.len() <= PIECES && pieces.into_iter().all(is_wide)),
    };
    (is_condition || is_concatenation) && !is_in_array
}

fn is_wire(scope: &Scope, value: &Expression) -> bool {
    matches!(value.node, Node::Signal(id) if !matches!(scope.signals[id].role, Role::Constant(_)))
}

/// The only bit of a signal is the signal.
fn whole(value: &Expression) -> &Expression {
    match &value.node {
        Node::Bit(x, _) if x.ty.bits == 1 && matches!(x.node, Node::Signal(_)) => x,
        _ => value,
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
