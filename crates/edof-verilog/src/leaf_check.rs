//! Holds a leaf's block to what the leaf's text says: its ports, their widths and directions, its parameters.

use rust_hdl::prelude::AtomKind;

use crate::Direction;
use crate::collect::{Tree, Wire};
use crate::error::Fault;
use crate::leaf::Leaf;
use crate::leaf_text::LeafText;

/// Rejects a leaf that its block connects wrongly.
pub(crate) fn check(part: &Tree, leaf: &Leaf, text: &LeafText) -> Result<(), Fault> {
    let misfit = |what: String| Fault::LeafMisfit { leaf: leaf.module.clone(), what };
    for (name, _) in &leaf.parameters {
        if !text.parameters.iter().any(|(parameter, _)| parameter == name) {
            return Err(misfit(format!("has no parameter `{name}`")));
        }
    }
    for (name, field) in &leaf.ports {
        let wire = part
            .wire(field)
            .ok_or_else(|| Fault::LeafPort { leaf: leaf.module.clone(), port: field.clone() })?;
        let port = text.ports.iter().find(|port| port.name == *name);
        let port = port.ok_or_else(|| misfit(format!("has no port `{name}`")))?;
        let bits = text.bits(port, &leaf.parameters);
        let bits = bits.ok_or_else(|| misfit(format!("does not say how wide `{name}` is")))?;
        let found = (direction(wire), wire.ty.bits);
        if found != (Some(port.direction), bits) {
            let wanted = said(Some(port.direction), bits);
            return Err(misfit(format!(
                "has `{name}` as {wanted}, the block has `{field}` as {}",
                said(found.0, found.1)
            )));
        }
    }
    for port in text.ports.iter().filter(|port| port.direction == Direction::Input) {
        if !leaf.ports.iter().any(|(name, _)| *name == port.name) {
            return Err(misfit(format!("has the input `{}`, which the block does not connect", port.name)));
        }
    }
    Ok(())
}

fn direction(wire: &Wire) -> Option<Direction> {
    match wire.kind {
        AtomKind::InputParameter => Some(Direction::Input),
        AtomKind::OutputParameter => Some(Direction::Output),
        _ => None,
    }
}

fn said(direction: Option<Direction>, bits: usize) -> String {
    let direction = match direction {
        Some(Direction::Input) => "input",
        Some(Direction::Output) => "output",
        None => "neither input nor output",
    };
    format!("{direction} of {bits} bit{}", if bits == 1 { "" } else { "s" })
}
