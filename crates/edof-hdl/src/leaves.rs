//! The files of `rtl/` that a circuit can stand on, and instances of them.

use crate::crossing::clocks;
use edof_verilog::leaf::Leaf;
use std::collections::{BTreeMap, BTreeSet};

/// The hand-written leaves of `rtl/`, by module name.
pub const LEAVES: &[(&str, &str)] = &[
    ("edof_add", include_str!("../../../rtl/edof_add.v")),
    ("edof_add4", include_str!("../../../rtl/edof_add4.v")),
    ("edof_async_fifo", include_str!("../../../rtl/edof_async_fifo.v")),
    ("edof_bus_sync", include_str!("../../../rtl/edof_bus_sync.v")),
    ("edof_clear", include_str!("../../../rtl/edof_clear.v")),
    ("edof_crc", include_str!("../../../rtl/edof_crc.v")),
    ("edof_ddr_out", include_str!("../../../rtl/edof_ddr_out.v")),
    ("edof_delay", include_str!("../../../rtl/edof_delay.v")),
    ("edof_fifo", include_str!("../../../rtl/edof_fifo.v")),
    ("edof_macc", include_str!("../../../rtl/edof_macc.v")),
    ("edof_macc_array", include_str!("../../../rtl/edof_macc_array.v")),
    ("edof_macc_bank", include_str!("../../../rtl/edof_macc_bank.v")),
    ("edof_memory", include_str!("../../../rtl/edof_memory.v")),
    ("edof_power_on", include_str!("../../../rtl/edof_power_on.v")),
    ("edof_pulse_sync", include_str!("../../../rtl/edof_pulse_sync.v")),
    ("edof_queue", include_str!("../../../rtl/edof_queue.v")),
    ("edof_ram", include_str!("../../../rtl/edof_ram.v")),
    ("edof_reset_sync", include_str!("../../../rtl/edof_reset_sync.v")),
    ("edof_scale", include_str!("../../../rtl/edof_scale.v")),
    ("edof_serialiser", include_str!("../../../rtl/edof_serialiser.v")),
    ("edof_start", include_str!("../../../rtl/edof_start.v")),
    ("edof_sync", include_str!("../../../rtl/edof_sync.v")),
    ("edof_table", include_str!("../../../rtl/edof_table.v")),
];

/// An instance of a leaf of `rtl/`, without parameters and ports; its text holds what it instantiates, and where it may connect clock domains
/// its ports' clocks are set. A module that is not in `rtl/` has no text, which the backend rejects.
#[must_use]
pub fn leaf(module: &str) -> Leaf {
    let parts = with_parts(&BTreeSet::from([module.to_owned()]));
    let own = parts.get(module).copied().unwrap_or_default();
    let others = parts.iter().filter(|(name, _)| **name != module).map(|(_, text)| *text);
    let leaf = Leaf::new(module, &std::iter::once(own).chain(others).collect::<Vec<_>>().join("\n"));
    match clocks::of(module) {
        Some(ports) => leaf.crossing(ports),
        None => leaf,
    }
}

/// The leaves of these names and those that they instantiate, a line of which begins with the name of its module.
pub(crate) fn with_parts(names: &BTreeSet<String>) -> BTreeMap<&'static str, &'static str> {
    let mut found = BTreeMap::new();
    let mut wanted: Vec<&str> = names.iter().map(String::as_str).collect();
    while let Some(name) = wanted.pop() {
        let leaf = LEAVES.iter().find(|(leaf, _)| *leaf == name);
        if let Some((name, text)) = leaf.filter(|(leaf, _)| !found.contains_key(leaf)) {
            found.insert(*name, *text);
            wanted.extend(text.lines().filter_map(|line| line.split_whitespace().next()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_of_every_leaf_are_registered() {
        for (name, _) in LEAVES {
            assert_eq!(edof_verilog::leaf::paths(&leaf(name).source), Ok(vec![]), "{name}");
        }
    }

    #[test]
    fn a_leaf_has_the_text_of_its_parts_and_the_clocks_of_a_crossing() {
        assert!(leaf("edof_macc_array").source.contains("module edof_macc_bank"));
        assert!(leaf("edof_async_fifo").crossing.is_some());
        assert_eq!(leaf("edof_ram").crossing, None);
    }
}
