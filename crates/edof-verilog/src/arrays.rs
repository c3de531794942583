//! Arrays of equal parts that a generate loop can say.
//!
//! A kernel's loop over parts comes here unrolled. It is rolled up again where all parts share one module and each input is the same for
//! all, the part's own number, or what the neighbour gives; the last neighbour is then what stands in its place. Memory images may
//! have the part's number in their name. Any other array stays as many instances.

use std::collections::BTreeSet;

use crate::collect::Tree;
use crate::domains::crosses;
use crate::expression::{Expression, Node};
use crate::kind::{Kind, pins_of};
use crate::scope::{Role, Scope, SignalId};

/// An array that a loop can say.
pub(crate) struct Array {
    /// Field name.
    pub key: String,
    /// Which parts of the scope, in order.
    pub parts: Vec<usize>,
    /// Pins, in the order of the module's.
    pub pins: Vec<Pin>,
}

/// What a pin of every part is connected to.
pub(crate) enum Pin {
    /// One value for all.
    Same(Expression),
    /// The part's number, in the given bits.
    Number(usize),
    /// What pin `from` of the next part gives, or of the one before; `end` without one.
    Neighbour { from: usize, next: bool, end: Expression },
    /// An output. `next` where a neighbour reads it: its array has one element more.
    Output { next: Option<bool> },
}

/// Arrays that could be loops as far as their parts are concerned: two or more of one kind. Clock-domain crossings stay separate,
/// so that constraints can name each.
pub(crate) fn candidates(scope: &Scope, tree: &Tree, kinds: &[Option<Kind>]) -> Vec<(String, Vec<usize>)> {
    let mut arrays: Vec<(String, Vec<usize>)> = vec![];
    for (n, part) in scope.parts.iter().enumerate().filter(|(_, part)| !crosses(&tree.parts[part.index])) {
        let Some((base, number)) = tree.parts[part.index].key.rsplit_once('$') else { continue };
        match arrays.last_mut() {
            Some((key, parts)) if key == base && number == parts.len().to_string() => parts.push(n),
            _ if number == "0" => arrays.push((base.into(), vec![n])),
            _ => {}
        }
    }
    let kind = |n: usize| kinds[scope.parts[n].index].as_ref();
    let alike = |parts: &[usize]| {
        let first = kind(parts[0]);
        parts.len() > 1
            && parts.iter().enumerate().skip(1).all(|(i, n)| match (first, kind(parts[1]), kind(*n)) {
                (Some(first), Some(second), Some(other)) => {
                    first.is_like(other, i) && first.differs(other) == first.differs(second)
                }
                _ => false,
            })
    };
    arrays.retain(|(_, parts)| alike(parts));
    arrays
}

/// The outputs of the parts of arrays: they need wires of their own.
pub(crate) fn outputs<'a>(scope: &Scope, parts: impl Iterator<Item = &'a usize>) -> BTreeSet<SignalId> {
    let signals = parts.flat_map(|n| scope.parts[*n].ports.iter().map(|port| port.1));
    signals.filter(|id| scope.signals[*id].role == Role::PartOutput).collect()
}

impl Array {
    /// The array as a loop, if its pins can be.
    pub fn of(
        scope: &Scope,
        (key, parts): &(String, Vec<usize>),
        kinds: &[Option<Kind>],
        resolved: &[Expression],
    ) -> Option<Self> {
        let pins: Vec<Vec<SignalId>> = parts
            .iter()
            .map(|n| {
                let kind = kinds[scope.parts[*n].index].as_ref()?;
                Some(pins_of(&scope.parts[*n], kind).into_iter().map(|pin| pin.1).collect())
            })
            .collect::<Option<_>>()?;
        let count = pins[0].len();
        let mut found: Vec<Pin> = (0..count)
            .map(|pin| {
                if scope.signals[pins[0][pin]].role == Role::PartOutput {
                    return Some(Pin::Output { next: None });
                }
                let values: Vec<&Expression> = pins.iter().map(|part| &resolved[part[pin]]).collect();
                same(scope, &values, &pins)
                    .or_else(|| number(scope, &values))
                    .or_else(|| neighbour(&values, &pins))
            })
            .collect::<Option<_>>()?;
        for pin in 0..count {
            let Pin::Neighbour { from, next, .. } = found[pin] else { continue };
            match &mut found[from] {
                Pin::Output { next: read } if read.is_none_or(|read| read == next) => *read = Some(next),
                _ => return None,
            }
        }
        // Through an array of wires even a path that ends looks like a loop.
        let first = &scope.parts[parts[0]];
        let kind = kinds[first.index].as_ref()?;
        let names = pins_of(first, kind);
        let is_path = |from: usize, to: usize| kind.has_path(&names[from].0, &names[to].0);
        let ins = || found.iter().enumerate().filter(|(_, pin)| matches!(pin, Pin::Neighbour { .. }));
        let outs =
            || found.iter().enumerate().filter(|(_, pin)| matches!(pin, Pin::Output { next: Some(_) }));
        if ins().any(|(from, _)| outs().any(|(to, _)| is_path(from, to))) {
            return None;
        }
        let ends = found.iter().filter_map(|pin| match pin {
            Pin::Neighbour { from, end, .. } => Some((*from, end)),
            _ => None,
        });
        let ends: Vec<_> = ends.collect();
        let one_end = ends.iter().all(|(from, end)| ends.iter().all(|(f, e)| f != from || e == end));
        one_end.then(|| Self { key: key.clone(), parts: parts.clone(), pins: found })
    }
}

impl Array {
    /// The signals at the pins of one part.
    pub fn signals(&self, scope: &Scope, kinds: &[Option<Kind>], element: usize) -> Vec<SignalId> {
        let part = &scope.parts[self.parts[element]];
        kinds[part.index]
            .as_ref()
            .map_or(vec![], |kind| pins_of(part, kind).into_iter().map(|pin| pin.1).collect())
    }
}

/// A signal that is not one of the array's own, or a literal.
fn same(scope: &Scope, values: &[&Expression], pins: &[Vec<SignalId>]) -> Option<Pin> {
    let is_atom = match values[0].node {
        Node::Signal(id) => {
            let has_own_wire = scope.signals[id].role == Role::PartInput;
            !has_own_wire && pins.iter().all(|part| !part.contains(&id))
        }
        Node::Literal(_) => true,
        _ => false,
    };
    (is_atom && values.iter().all(|value| *value == values[0])).then(|| Pin::Same(values[0].clone()))
}

fn number(scope: &Scope, values: &[&Expression]) -> Option<Pin> {
    let is_number = |(i, value): (usize, &&Expression)| match &value.node {
        Node::Literal(number) => *number == i as i128,
        Node::Signal(id) => match &scope.signals[*id].role {
            Role::Constant(digits) => u64::from_str_radix(digits, 16) == Ok(i as u64),
            _ => false,
        },
        _ => false,
    };
    values.iter().enumerate().all(is_number).then(|| Pin::Number(values[0].ty.bits))
}

fn neighbour(values: &[&Expression], pins: &[Vec<SignalId>]) -> Option<Pin> {
    let last = values.len() - 1;
    let is = |value: &Expression, id: SignalId| value.node == Node::Signal(id);
    for from in 0..pins[0].len() {
        if (0..last).all(|i| is(values[i], pins[i + 1][from])) {
            return Some(Pin::Neighbour { from, next: true, end: end(values[last], pins)? });
        }
        if (1..=last).all(|i| is(values[i], pins[i - 1][from])) {
            return Some(Pin::Neighbour { from, next: false, end: end(values[0], pins)? });
        }
    }
    None
}

/// What stands at the end of a chain: a signal outside of the array, or a literal.
fn end(value: &Expression, pins: &[Vec<SignalId>]) -> Option<Expression> {
    let outside = match value.node {
        Node::Signal(id) => pins.iter().all(|part| !part.contains(&id)),
        Node::Literal(_) => true,
        _ => false,
    };
    outside.then(|| value.clone())
}

/// `BANKS` of `banks`.
pub(crate) fn count_name(array: &Array) -> String {
    array.key.replace('$', "_").to_uppercase()
}

/// `banks_sum` of `banks_sum[3]`.
pub(crate) fn array_name(element: &str) -> &str {
    element.split('[').next().unwrap_or(element)
}
