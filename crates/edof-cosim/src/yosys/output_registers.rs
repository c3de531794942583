//! The output registers of block RAMs, which Yosys leaves outside: every 7-series tool takes them in (UG473, DO_REG; UG901), and a block RAM with
//! its register is out after 0.882 ns, without it after 2.454.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Types of block RAM.
pub const BLOCK_RAMS: [&str; 2] = ["RAMB36E1", "RAMB18E1"];
/// What the type of a block RAM with its output registers ends in.
pub const WITH_REGISTERS: &str = "_REG";
/// Pins with data.
const OUTPUTS: [&str; 4] = ["DOADO", "DOBDO", "DOPADOP", "DOPBDOP"];

/// Takes flip-flops into the block RAMs of a flat top: where every bit that is read leads to one flip-flop without enable and reset of the RAM's
/// own clock, and nowhere else. Gives the number of flip-flops.
pub fn take_in(netlist: &mut Value) -> usize {
    let modules = netlist["modules"].as_object_mut();
    let Some(top) = modules
        .and_then(|modules| modules.values_mut().find(|module| module["attributes"].get("top").is_some()))
    else {
        return 0;
    };
    let plans = plans(top);
    let Some(cells) = top["cells"].as_object_mut() else { return 0 };
    let mut taken = 0;
    for (ram, registers) in plans {
        for (pin, bit, register) in registers {
            let Some(register) = cells.remove(&register) else { continue };
            cells[&ram]["connections"][pin][bit] = register["connections"]["Q"][0].clone();
            taken += 1;
        }
        let kind = format!("{}{WITH_REGISTERS}", cells[&ram]["type"].as_str().unwrap_or(""));
        // Without parameters it is the type as it stands in the library.
        cells[&ram]["type"] = json!(kind);
        cells[&ram]["parameters"] = json!({});
    }
    taken
}

/// Of each block RAM that has registers: pin, bit and register.
type Plans<'a> = BTreeMap<String, Vec<(&'a str, usize, String)>>;

fn plans(top: &Value) -> Plans<'static> {
    let Some(cells) = top["cells"].as_object() else { return BTreeMap::new() };
    let mut loads: BTreeMap<u64, Vec<(&String, &String)>> = BTreeMap::new();
    for (name, cell) in cells {
        for (pin, bits) in cell["connections"].as_object().into_iter().flatten() {
            if cell["port_directions"][pin] == "input" {
                nets(bits).for_each(|(_, net)| loads.entry(net).or_default().push((name, pin)));
            }
        }
    }
    let ports = top["ports"].as_object().into_iter().flat_map(|ports| ports.values());
    let leaving: BTreeSet<u64> = ports
        .filter(|port| port["direction"] != "input")
        .flat_map(|port| nets(&port["bits"]).map(|(_, net)| net).collect::<Vec<_>>())
        .collect();
    let plan = |(name, ram): (&String, &Value)| {
        let mut plan = vec![];
        for pin in OUTPUTS {
            let clock = if pin.contains('A') && !pin.contains("DOB") && !pin.contains("DOPB") {
                "CLKARDCLK"
            } else {
                "CLKBWRCLK"
            };
            for (bit, net) in nets(&ram["connections"][pin]) {
                match loads.get(&net).map_or(&[][..], Vec::as_slice) {
                    [] if !leaving.contains(&net) => {}
                    [(register, input)] if !leaving.contains(&net) && *input == "D" => {
                        let cell = &cells[*register];
                        let wires = &cell["connections"];
                        let is_plain = cell["type"] == "FDRE"
                            && wires["CE"] == json!(["1"])
                            && wires["R"] == json!(["0"])
                            && wires["C"] == ram["connections"][clock];
                        if !is_plain {
                            return None;
                        }
                        plan.push((pin, bit, (*register).clone()));
                    }
                    _ => return None,
                }
            }
        }
        (!plan.is_empty()).then(|| (name.clone(), plan))
    };
    let rams = cells.iter().filter(|(_, cell)| BLOCK_RAMS.iter().any(|kind| cell["type"] == *kind));
    rams.filter_map(plan).collect()
}

/// The nets among the bits of a pin, with their places.
fn nets(bits: &Value) -> impl Iterator<Item = (usize, u64)> + '_ {
    bits.as_array().into_iter().flatten().enumerate().filter_map(|(bit, net)| Some((bit, net.as_u64()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A RAM whose bits lead to flip-flops; the second one's enable, and another load of the first bit.
    fn netlist(enable: &str, other_load: u64) -> Value {
        let register = |d: u64, q: u64, enable: &str| {
            json!({"type": "FDRE", "port_directions": {"C": "input", "CE": "input", "D": "input", "R": "input", "Q": "output"},
                "connections": {"C": [1], "CE": [enable], "D": [d], "R": ["0"], "Q": [q]}})
        };
        json!({"modules": {"top": {"attributes": {"top": "1"}, "ports": {"out": {"direction": "output", "bits": [6, 7]}}, "cells": {
            "ram": {"type": "RAMB36E1", "parameters": {"DOA_REG": "0"}, "port_directions": {"DOADO": "output", "CLKARDCLK": "input"},
                "connections": {"DOADO": [2, 3, 4], "CLKARDCLK": [1]}},
            "one": register(2, 6, "1"),
            "two": register(3, 7, enable),
            "lut": {"type": "LUT1", "port_directions": {"I0": "input", "O": "output"}, "connections": {"I0": [other_load], "O": [9]}}}}}})
    }

    #[test]
    fn registers_that_only_a_block_ram_feeds_become_its_own() {
        let mut found = netlist("1", 8);
        assert_eq!(take_in(&mut found), 2);
        let cells = &found["modules"]["top"]["cells"];
        assert_eq!(cells["ram"]["type"], "RAMB36E1_REG");
        assert_eq!(cells["ram"]["connections"]["DOADO"], json!([6, 7, 4]));
        assert!(cells.get("one").is_none() && cells.get("two").is_none() && cells.get("lut").is_some());
    }

    #[test]
    fn a_register_with_an_enable_or_a_word_that_is_read_elsewhere_stays_outside() {
        for (enable, load) in [("x", 8), ("1", 2)] {
            let mut found = netlist(enable, load);
            let before = found.clone();
            assert_eq!(take_in(&mut found), 0);
            assert_eq!(found, before);
        }
    }
}
