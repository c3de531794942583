//! The part of Yosys's JSON netlist that we read.

pub mod paths;

use super::fan_out::FanOut;
use super::{Dsp, Report};
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;

/// All modules, most of them primitives.
#[derive(Deserialize)]
pub struct Netlist {
    modules: BTreeMap<String, Module>,
}

#[derive(Deserialize)]
struct Module {
    #[serde(default)]
    attributes: BTreeMap<String, Value>,
    #[serde(default)]
    parameter_default_values: BTreeMap<String, Value>,
    #[serde(default)]
    ports: BTreeMap<String, Port>,
    #[serde(default)]
    cells: BTreeMap<String, Cell>,
    #[serde(default)]
    netnames: BTreeMap<String, Wire>,
}

#[derive(Deserialize)]
struct Port {
    direction: String,
    bits: Vec<Bit>,
}

#[derive(Deserialize)]
struct Wire {
    hide_name: u8,
    bits: Vec<Bit>,
    #[serde(default)]
    attributes: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
struct Cell {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    parameters: BTreeMap<String, String>,
    #[serde(default)]
    port_directions: BTreeMap<String, String>,
    #[serde(default)]
    connections: BTreeMap<String, Vec<Bit>>,
}

/// A net, or a constant: `0`, `1`, `x`, `z`.
#[derive(Deserialize, PartialEq, Eq, PartialOrd, Ord, Clone)]
#[serde(untagged)]
enum Bit {
    Net(u64),
    Constant(String),
}

impl Bit {
    const fn net(&self) -> Option<u64> {
        if let Self::Net(net) = self { Some(*net) } else { None }
    }
}

impl Netlist {
    /// Reads a file of `write_json`.
    pub fn read(file: impl Read) -> Result<Self, serde_json::Error> {
        serde_json::from_reader(file)
    }

    /// What a flat top is made of; none where there is no top.
    pub fn report(&self) -> Option<Report> {
        let top = self.modules.values().find(|module| module.attributes.contains_key("top"))?;
        let (to_carry, free) = (top.nets_to_carry(), top.free_registers());
        let mut report = Report::default();
        for (name, cell) in &top.cells {
            *report.cells.0.entry(cell.kind.clone()).or_default() += 1;
            if cell.kind == "DSP48E1" {
                report.dsps.push(cell.dsp(name, &to_carry, &free));
            }
        }
        Some(report)
    }

    /// Registers of a flat top that drive banks of more than one group of `group` neighbours; empty without a top.
    pub fn strays(&self, group: usize) -> Option<Vec<String>> {
        Some(self.modules.values().find(|module| module.attributes.contains_key("top"))?.strays(group))
    }

    /// How many borders between groups of `group` banks a path of a flat top crosses at most, and the register where it begins; none without a top.
    pub fn crossed(&self, group: usize) -> Option<(usize, String)> {
        Some(self.modules.values().find(|module| module.attributes.contains_key("top"))?.crossed(group))
    }

    /// All nets of a flat top but its clocks, those with the most loads first; none where there is no top.
    pub fn fan_out(&self) -> Option<Vec<FanOut>> {
        let top = self.modules.values().find(|module| module.attributes.contains_key("top"))?;
        let names = top.names();
        let mut nets: Vec<FanOut> =
            top.loads().into_iter().map(|(net, loads)| loads.told(net, &names)).collect();
        nets.sort_by(|a, b| b.loads.cmp(&a.loads).then_with(|| a.net.cmp(&b.net)));
        Some(nets)
    }
}

/// Pins to which a net leads.
#[derive(Default)]
struct Loads {
    count: usize,
    /// Pins among them that enable, reset or write.
    controls: usize,
}

impl Loads {
    fn told(&self, net: u64, names: &BTreeMap<u64, (String, bool)>) -> FanOut {
        let controls = 2 * self.controls > self.count;
        match names.get(&net) {
            Some((name, single)) => {
                FanOut { net: name.clone(), loads: self.count, control: controls || *single }
            }
            None => FanOut { net: format!("net {net}"), loads: self.count, control: controls },
        }
    }
}

/// Pins that only a clock drives.
const CLOCK_PINS: [&str; 6] = ["C", "CLK", "WCLK", "CLKARDCLK", "CLKBWRCLK", "G"];
/// Starts of the names of pins that enable, write or choose an operation.
const CONTROL_PINS: [&str; 7] = ["CE", "WE", "EN", "RST", "REGCE", "OPMODE", "INMODE"];

/// Whether a pin enables, resets, writes or chooses an operation. A flip-flop's R and S are not the S of a multiplexer.
fn is_control(cell: &Cell, pin: &str) -> bool {
    let resets = cell.kind.starts_with("FD") && matches!(pin, "R" | "S" | "CLR" | "PRE");
    resets || CONTROL_PINS.iter().any(|name| pin.starts_with(name))
}

impl Module {
    /// The loads of every net except clocks.
    fn loads(&self) -> BTreeMap<u64, Loads> {
        let mut loads: BTreeMap<u64, Loads> = BTreeMap::new();
        let mut clocks = BTreeSet::new();
        for cell in self.cells.values() {
            for (pin, bits) in &cell.connections {
                if cell.port_directions.get(pin).is_none_or(|direction| direction != "input") {
                    continue;
                }
                for bit in bits {
                    let Bit::Net(net) = bit else { continue };
                    if CLOCK_PINS.contains(&pin.as_str()) {
                        clocks.insert(*net);
                    }
                    let entry = loads.entry(*net).or_default();
                    entry.count += 1;
                    entry.controls += usize::from(is_control(cell, pin));
                }
            }
        }
        loads.retain(|net, _| !clocks.contains(net));
        loads
    }

    /// A name for each net, and whether it is a signal of one bit: of the source's names the shortest.
    fn names(&self) -> BTreeMap<u64, (String, bool)> {
        let mut names: BTreeMap<u64, (String, bool)> = BTreeMap::new();
        for (name, wire) in self.netnames.iter().filter(|(_, wire)| wire.hide_name == 0) {
            let single = wire.bits.len() == 1;
            for (place, bit) in wire.bits.iter().enumerate() {
                let Bit::Net(net) = bit else { continue };
                let told = if single { name.clone() } else { format!("{name} [{place}]") };
                let longer = names.get(net).is_some_and(|(known, _)| known.len() <= told.len());
                if !longer {
                    names.insert(*net, (told, single));
                }
            }
        }
        names
    }

    /// Outputs of flip-flops that have one load and that nothing keeps: a tool may take such a register into its load.
    fn free_registers(&self) -> BTreeSet<u64> {
        let is_kept = |wire: &&Wire| wire.attributes.contains_key("keep");
        let bits = |wire: &'_ Wire| wire.bits.iter().filter_map(Bit::net).collect::<Vec<_>>();
        let kept: BTreeSet<u64> = self.netnames.values().filter(is_kept).flat_map(bits).collect();
        let loads = self.loads();
        let registers = self.cells.values().filter(|cell| cell.kind.starts_with("FD"));
        registers
            .flat_map(|cell| cell.nets(&["Q"]))
            .filter(|net| !kept.contains(net) && loads.get(net).is_some_and(|loads| loads.count == 1))
            .collect()
    }

    /// Registers whose outputs lead, directly or through logic, to banks of more than one group of `group` neighbours: name and groups. A bank is
    /// an instance `banks[N].`.
    fn strays(&self, group: usize) -> Vec<String> {
        let all = self.names();
        let reached = self.reached(&self.bank_groups(group));
        let strays = reached.into_iter().filter(|(_, found)| found.len() > 1);
        let told = strays.map(|(net, found)| format!("{}: groups {found:?}", told(&all, net)));
        told.collect()
    }

    /// The path from register to register that crosses most borders between rooms: how many, and where it begins. A room has the banks of a
    /// group and what is in `groups[N].`; rooms stand in the order of their numbers.
    fn crossed(&self, group: usize) -> (usize, String) {
        let mut rooms = self.bank_groups(group);
        rooms.extend(self.registers_in("groups["));
        let mut most = (0, None);
        for (net, found) in self.reached(&rooms) {
            let all = || found.iter().chain(rooms.get(&net));
            if let (Some(first), Some(last)) = (all().min(), all().max())
                && last - first > most.0
            {
                most = (last - first, Some(net));
            }
        }
        (most.0, most.1.map_or_else(String::new, |net| told(&self.names(), net)))
    }

    /// The rooms to whose registers each register leads, directly or through logic.
    fn reached(&self, rooms: &BTreeMap<u64, usize>) -> Vec<(u64, BTreeSet<usize>)> {
        let mut readers: BTreeMap<u64, Vec<&Cell>> = BTreeMap::new();
        for cell in self.cells.values() {
            let inputs = cell.connections.iter().filter(|(pin, _)| {
                cell.port_directions.get(*pin).is_some_and(|direction| direction == "input")
                    && !CLOCK_PINS.contains(&pin.as_str())
            });
            for net in inputs.flat_map(|(_, bits)| bits).filter_map(Bit::net) {
                readers.entry(net).or_default().push(cell);
            }
        }
        let registers = self.cells.values().filter(|cell| !cell.is_logic());
        let outputs = registers.flat_map(Cell::outputs).collect::<BTreeSet<u64>>();
        let reached = |net: u64| {
            let (mut found, mut seen, mut open) = (BTreeSet::new(), BTreeSet::new(), vec![net]);
            while let Some(net) = open.pop() {
                for cell in readers.get(&net).into_iter().flatten() {
                    let fresh = cell.outputs().filter(|net| seen.insert(*net));
                    if cell.is_logic() {
                        open.extend(fresh);
                    } else {
                        found.extend(cell.outputs().filter_map(|net| rooms.get(&net)));
                    }
                }
            }
            (net, found)
        };
        outputs.into_iter().map(reached).collect()
    }

    /// The group of banks in which a net is driven.
    fn bank_groups(&self, group: usize) -> BTreeMap<u64, usize> {
        self.registers_in("banks[").into_iter().map(|(net, bank)| (net, bank / group)).collect()
    }

    /// The number of the instance in which a net is driven, whose name begins with `word`: its register is named there.
    fn registers_in(&self, word: &str) -> BTreeMap<u64, usize> {
        let mut numbers = BTreeMap::new();
        for (name, wire) in &self.netnames {
            let Some((_, inside)) = name.split_once(word) else { continue };
            let number = inside.split_once(']').and_then(|(number, _)| number.parse().ok());
            let is_own = name.ends_with("_q") || name.ends_with(".sum") || name.ends_with("sum_o");
            if let Some(number) = number.filter(|_| is_own) {
                numbers.extend(wire.bits.iter().filter_map(Bit::net).map(|net| (net, number)));
            }
        }
        numbers
    }

    /// Nets that enter a carry chain, directly or through one LUT.
    fn nets_to_carry(&self) -> BTreeSet<u64> {
        let carries = self.cells.values().filter(|cell| cell.kind == "CARRY4");
        let direct: BTreeSet<u64> = carries.flat_map(|cell| cell.nets(&["S", "DI", "CYINIT"])).collect();
        let luts = self.cells.values().filter(|cell| cell.kind.starts_with("LUT"));
        let before = luts.filter(|lut| lut.nets(&["O"]).any(|net| direct.contains(&net)));
        let through: BTreeSet<u64> =
            before.flat_map(|lut| lut.nets(&["I0", "I1", "I2", "I3", "I4", "I5"])).collect();
        direct.union(&through).copied().collect()
    }
}

/// What a net is called.
fn told(names: &BTreeMap<u64, (String, bool)>, net: u64) -> String {
    names.get(&net).map_or_else(|| format!("net {net}"), |(name, _)| name.clone())
}

impl Cell {
    /// Whether paths go through it.
    fn is_logic(&self) -> bool {
        ["LUT", "MUXF", "CARRY4", "INV"].iter().any(|kind| self.kind.starts_with(kind))
    }

    fn outputs(&self) -> impl Iterator<Item = u64> {
        let is_output =
            |pin: &&String| self.port_directions.get(*pin).is_some_and(|direction| direction == "output");
        let pins = self.connections.keys().filter(is_output).cloned().collect::<Vec<_>>();
        pins.into_iter().flat_map(|pin| self.connections[&pin].iter().filter_map(Bit::net))
    }

    fn nets(&self, ports: &'static [&str]) -> impl Iterator<Item = u64> {
        let bits = ports.iter().filter_map(|&port| self.connections.get(port)).flatten();
        bits.filter_map(Bit::net)
    }

    /// Parameters are binary text.
    fn is_set(&self, parameter: &str) -> bool {
        self.parameters.get(parameter).is_some_and(|value| value.contains('1'))
    }

    /// Bits 6 to 4 of OPMODE select Z: 010 is P (UG479, table 2-9).
    fn dsp(&self, name: &str, to_carry: &BTreeSet<u64>, free: &BTreeSet<u64>) -> Dsp {
        let opmode = self.connections.get("OPMODE");
        let may_be = |bit: usize, value: &str| match opmode.and_then(|bits| bits.get(bit)) {
            Some(Bit::Net(_)) => true,
            Some(Bit::Constant(constant)) => constant == value,
            None => false,
        };
        Dsp {
            name: name.into(),
            registers_result: self.is_set("PREG"),
            registers_product: self.is_set("MREG"),
            registers_factors: self.is_set("AREG") && self.is_set("BREG"),
            sums_inside: may_be(6, "0") && may_be(5, "1") && may_be(4, "0"),
            free_operation: self.nets(&["OPMODE"]).all(|net| free.contains(&net)),
            feeds_carry: self.nets(&["P"]).any(|net| to_carry.contains(&net)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A top in which register 2 leads to a bank's register, and through a LUT to another bank's; the library states what they take.
    fn netlist(other_bank: usize) -> [Netlist; 2] {
        let register = |d: u64, q: u64| {
            format!(
                r#"{{"type": "FDRE", "port_directions": {{"C": "input", "D": "input", "Q": "output"}}, "connections": {{"C": [1], "D": [{d}], "Q": [{q}]}}}}"#
            )
        };
        let name = |net: u64| format!(r#"{{"hide_name": 0, "bits": [{net}]}}"#);
        let top = format!(
            r#"{{"modules": {{"top": {{"attributes": {{"top": 1}}, "ports": {{"in_i": {{"direction": "input", "bits": [9]}}}},
            "cells": {{"a": {}, "b": {}, "c": {}, "lut": {{"type": "LUT1", "port_directions": {{"I0": "input", "O": "output"}},
            "connections": {{"I0": [2], "O": [3]}}}}}},
            "netnames": {{"copy_q": {}, "banks[7].lanes.near_q": {}, "banks[{other_bank}].lanes.far_q": {}}}}}}}}}"#,
            register(9, 2),
            register(2, 4),
            register(3, 5),
            name(2),
            name(4),
            name(5)
        );
        let arc = |kind: &str, from: u64, to: u64, delay: &str| {
            format!(
                r#"{{"type": "{kind}", "parameters": {{"FULL": "0", "T_RISE_MAX": "{delay}", "T_FALL_MAX": "0", "T_LIMIT_MAX": "{delay}"}},
                "connections": {{"SRC": [{from}], "DST": [{to}]}}}}"#
            )
        };
        let port = |name: &str, direction: &str, net: u64| {
            format!(r#""{name}": {{"direction": "{direction}", "bits": [{net}]}}"#)
        };
        let library = format!(
            r#"{{"modules": {{"FDRE": {{"ports": {{{}, {}, {}}}, "cells": {{"leaves": {}, "ends": {}}}}},
            "LUT1": {{"ports": {{{}, {}}}, "cells": {{"through": {}}}}}}}}}"#,
            port("C", "input", 1),
            port("D", "input", 2),
            port("Q", "output", 3),
            arc("$specify3", 1, 3, "1010"),
            arc("$specrule", 2, 1, "11"),
            port("I0", "input", 1),
            port("O", "output", 2),
            arc("$specify2", 1, 2, "100")
        );
        [top, library].map(|text| Netlist::read(text.as_bytes()).unwrap())
    }

    #[test]
    fn a_register_that_leads_to_banks_of_two_groups_is_a_stray() {
        let strays = |bank: usize| netlist(bank)[0].strays(8).unwrap();
        assert_eq!(strays(6), [""; 0]);
        assert_eq!(strays(8), ["copy_q: groups {0, 1}"]);
    }

    #[test]
    fn a_path_to_a_room_further_on_crosses_those_between() {
        let crossed = |bank: usize| netlist(bank)[0].crossed(8).unwrap();
        assert_eq!(crossed(6), (0, String::new()));
        assert_eq!(crossed(8), (1, "copy_q".into()));
        assert_eq!(crossed(39), (4, "copy_q".into()));
    }

    #[test]
    fn kinds_of_paths_are_reported_longest_first() {
        let [top, library] = netlist(8);
        let kinds = top.kinds(&library).unwrap();
        let told: Vec<_> =
            kinds.iter().map(|kind| (kind.delay_ps, kind.from.as_str(), kind.to.as_str())).collect();
        let expected = [
            (17, "copy_q", "banks[8].lanes.far_q"),
            (13, "copy_q", "banks[7].lanes.near_q"),
            (3, "in_i", "copy_q"),
        ];
        // The name of an input's net is that of a wire, which this top has not.
        assert_eq!(
            told.iter().map(|kind| (kind.0, kind.2)).collect::<Vec<_>>(),
            expected.map(|kind| (kind.0, kind.2))
        );
        assert_eq!(told[0], expected[0]);
        assert_eq!(kinds[0].pin, "FDRE.D");
    }
}
