//! The part of Yosys's JSON netlist that we read.

use super::fan_out::FanOut;
use super::{Dsp, Report};
use serde::Deserialize;
use serde::de::IgnoredAny;
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
    attributes: BTreeMap<String, IgnoredAny>,
    #[serde(default)]
    cells: BTreeMap<String, Cell>,
    #[serde(default)]
    netnames: BTreeMap<String, Wire>,
}

#[derive(Deserialize)]
struct Wire {
    hide_name: u8,
    bits: Vec<Bit>,
    #[serde(default)]
    attributes: BTreeMap<String, IgnoredAny>,
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
    /// The loads of every net that is no clock.
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

impl Cell {
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
