//! What a part is an instance of, and what it is connected by.

use crate::Port;
use crate::error::rust_path;
use crate::leaf::Leaf;
use crate::scope::{Part, SignalId};
use crate::value::Value;

/// One block of the circuit: its module, the values of the module's slots, the same of its instances.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Occurrence {
    pub class: usize,
    pub values: Vec<Value>,
    /// None for leaves.
    pub parts: Vec<Option<Occurrence>>,
}

/// What a part is an instance of.
pub(crate) enum Kind<'a> {
    /// A module of ours, its ports, and which of them follow which within a cycle.
    Module { occurrence: &'a Occurrence, ports: &'a [Port], paths: &'a [(usize, usize)] },
    /// A leaf, and which of its ports follow which within a cycle.
    Leaf(Leaf, Vec<(String, String)>),
}

impl Kind<'_> {
    /// Whether one of its pins follows another within a cycle.
    pub fn has_path(&self, from: &str, to: &str) -> bool {
        match self {
            Kind::Module { paths, ports, .. } => {
                paths.iter().any(|(input, output)| ports[*input].name == from && ports[*output].name == to)
            }
            Kind::Leaf(_, paths) => paths.iter().any(|(input, output)| input == from && output == to),
        }
    }

    /// Which parameters of a leaf the other has otherwise.
    pub fn differs(&self, other: &Self) -> Vec<bool> {
        match (self, other) {
            (Kind::Leaf(one, _), Kind::Leaf(other, _)) => {
                one.parameters.iter().zip(&other.parameters).map(|(one, other)| one != other).collect()
            }
            _ => vec![],
        }
    }

    /// Whether the other, number `i` of an array whose number 0 this is, is equal except for its number.
    pub fn is_like(&self, other: &Self, i: usize) -> bool {
        match (self, other) {
            (Kind::Module { occurrence: one, .. }, Kind::Module { occurrence: other, .. }) => one == other,
            (Kind::Leaf(one, _), Kind::Leaf(other, _)) => {
                let alike = |(one, other): (&(String, String), &(String, String))| {
                    one.0 == other.0 && (one.1 == other.1 || numbered(&one.1, i).as_ref() == Some(&other.1))
                };
                let count = one.parameters.len() == other.parameters.len();
                one.module == other.module
                    && one.ports == other.ports
                    && count
                    && one.parameters.iter().zip(&other.parameters).all(alike)
            }
            _ => false,
        }
    }
}

/// The text with its last `00` replaced by the number.
fn numbered(text: &str, number: usize) -> Option<String> {
    let (before, after) = split_number(text)?;
    Some(format!("{before}{number:02}{after}"))
}

/// What stands before and after the last `00` of a text.
pub(crate) fn split_number(text: &str) -> Option<(&str, &str)> {
    text.starts_with('"').then_some(())?;
    text.rfind("00").map(|at| (&text[..at], &text[at + 2..]))
}

/// Pins of an instance: the module's name for each, and the signal, in the module's order.
pub(crate) fn pins_of(part: &Part, kind: &Kind) -> Vec<(String, SignalId)> {
    match kind {
        Kind::Module { ports, .. } => {
            let of = |port: &Port| part.ports.iter().find(|(key, _)| rust_path(key) == port.field);
            ports.iter().filter_map(|port| Some((port.name.clone(), of(port)?.1))).collect()
        }
        Kind::Leaf(leaf, _) => {
            let name =
                |field: &str| leaf.ports.iter().find(|(_, of)| of == field).map(|(name, _)| name.clone());
            part.ports.iter().filter_map(|(key, id)| Some((name(key)?, *id))).collect()
        }
    }
}
