//! The longest paths of a mapped design by kind, with the delays that Yosys' `sta` uses, which prints one path alone.

use super::{Bit, Cell, Module, Netlist};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};

/// The longest of all paths whose ends and beginnings have names that differ in their numbers alone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kind {
    /// Delay from clock edge to set-up in picoseconds, wires left out.
    pub delay_ps: u64,
    /// Where the path begins: the register's output in the source's own name, or an input.
    pub from: String,
    /// Where it ends: the register's output in the source's own name, else the cell's name; of an output its name.
    pub to: String,
    /// Type and pin of the cell at its end, such as `DSP48E1.OPMODE`; `output` for an output.
    pub pin: String,
}

type Pin = (String, usize);

/// Delays of one type of cell, by pin and bit, in picoseconds.
#[derive(Default)]
struct Arcs {
    /// To each output, the inputs that lead to it without a register.
    through: HashMap<Pin, Vec<(Pin, u64)>>,
    /// From the clock's edge to an output.
    leaves: HashMap<Pin, u64>,
    /// From an input to the clock's edge.
    ends: Vec<(Pin, u64)>,
}

impl Netlist {
    /// Of a flat top whose delays `library` states (`write_json` after `sta` and `proc`), each kind of path, the longest first. None where
    /// there is no top.
    pub fn kinds(&self, library: &Self) -> Option<Vec<Kind>> {
        let top = self.modules.values().find(|module| module.attributes.contains_key("top"))?;
        let mut types: HashMap<String, Arcs> = HashMap::new();
        for cell in top.cells.values() {
            types.entry(cell.registers()).or_insert_with(|| library.arcs(cell));
        }
        Some(Search::new(top, &types).kinds())
    }

    /// The delays of a cell: those of the module of its type whose registers are used in the same way.
    fn arcs(&self, cell: &Cell) -> Arcs {
        let derived = format!("\\{}", cell.kind);
        let is_alike = |(name, module): &(&String, &Module)| {
            let is_type = **name == cell.kind || module.hdlname().is_some_and(|of| of == derived);
            let mut registers = cell.parameters.iter().filter(|(name, _)| name.ends_with("REG"));
            is_type && registers.all(|(name, value)| module.states(name, value))
        };
        self.modules.iter().find(is_alike).map(|(_, module)| module.arcs()).unwrap_or_default()
    }
}

fn number(bits: &str) -> i32 {
    bits.chars().fold(0u32, |number, bit| number << 1 | u32::from(bit == '1')).cast_signed()
}

impl Cell {
    /// Which of its registers are used, with its type: all that delays depend on.
    fn registers(&self) -> String {
        let of = self.parameters.iter().filter(|(name, _)| name.ends_with("REG"));
        of.fold(self.kind.clone(), |told, (name, value)| format!("{told} {name}={}", number(value)))
    }

    fn delay(&self, kind: &str) -> u64 {
        let of = |name: &str| self.parameters.get(name).map_or(0, |bits| number(bits));
        let delay = match kind {
            "$specrule" => of("T_LIMIT_MAX"),
            _ => of("T_RISE_MAX").max(of("T_FALL_MAX")),
        };
        u64::try_from(delay).unwrap_or(0)
    }
}

impl Module {
    fn hdlname(&self) -> Option<&str> {
        self.attributes.get("hdlname")?.as_str()
    }

    fn arcs(&self) -> Arcs {
        let mut pins: HashMap<u64, Pin> = HashMap::new();
        for (name, port) in &self.ports {
            for (bit, net) in port.bits.iter().enumerate() {
                if let Bit::Net(net) = net {
                    pins.insert(*net, (name.clone(), bit));
                }
            }
        }
        let mut arcs = Arcs::default();
        for cell in self.cells.values() {
            let pins = |port: &str| -> Vec<Pin> {
                let bits = cell.connections.get(port).into_iter().flatten();
                bits.filter_map(|bit| pins.get(&bit.net()?).cloned()).collect()
            };
            let (from, to, delay) = (pins("SRC"), pins("DST"), cell.delay(&cell.kind));
            match cell.kind.as_str() {
                "$specify2" => {
                    let full = cell.parameters.get("FULL").is_some_and(|bit| bit.ends_with('1'));
                    for (place, to) in to.iter().enumerate() {
                        let sources = from.iter().enumerate().filter(|(other, _)| full || *other == place);
                        let sources = sources.map(|(_, from)| (from.clone(), delay));
                        arcs.through.entry(to.clone()).or_default().extend(sources);
                    }
                }
                "$specify3" => {
                    for to in to {
                        let known = arcs.leaves.entry(to).or_default();
                        *known = delay.max(*known);
                    }
                }
                "$specrule" => arcs.ends.extend(from.into_iter().map(|from| (from, delay))),
                _ => (),
            }
        }
        arcs
    }

    /// Whether a parameter was derived with that value.
    fn states(&self, name: &str, value: &str) -> bool {
        let own = self.parameter_default_values.get(name).and_then(serde_json::Value::as_str);
        own.is_none_or(|own| number(own) == number(value))
    }
}

/// The latest arrival at every net.
struct Search<'a> {
    top: &'a Module,
    types: &'a HashMap<String, Arcs>,
    /// What drives a net.
    drivers: HashMap<u64, (&'a Cell, Pin)>,
    names: BTreeMap<u64, (String, bool)>,
    /// The latest arrival at a net, and the net at which its path began; none where no path comes.
    known: HashMap<u64, Option<(u64, u64)>>,
}

impl<'a> Search<'a> {
    fn new(top: &'a Module, types: &'a HashMap<String, Arcs>) -> Self {
        let mut drivers = HashMap::new();
        for cell in top.cells.values() {
            for (pin, bits) in &cell.connections {
                if cell.port_directions.get(pin).is_none_or(|direction| direction != "output") {
                    continue;
                }
                for (place, net) in
                    bits.iter().enumerate().filter_map(|(place, bit)| Some((place, bit.net()?)))
                {
                    drivers.insert(net, (cell, (pin.clone(), place)));
                }
            }
        }
        // An input is there at the clock's edge.
        let inputs = top.ports.values().filter(|port| port.direction == "input");
        let known =
            inputs.flat_map(|port| &port.bits).filter_map(|bit| Some((bit.net()?, Some((0, bit.net()?)))));
        Self { top, types, drivers, names: top.names(), known: known.collect() }
    }

    fn arrival(&mut self, net: u64) -> Option<(u64, u64)> {
        if let Some(known) = self.known.get(&net) {
            return *known;
        }
        self.known.insert(net, None);
        let types = self.types;
        let (cell, pin) = self.drivers.get(&net)?.clone();
        let arcs = types.get(&cell.registers())?;
        let mut latest = arcs.leaves.get(&pin).map(|delay| (*delay, net));
        for ((name, bit), delay) in arcs.through.get(&pin).into_iter().flatten() {
            let Some(source) = cell.net(name, *bit) else { continue };
            let arrival = self.arrival(source).map(|(time, from)| (time + delay, from));
            latest = latest.max(arrival);
        }
        self.known.insert(net, latest);
        latest
    }

    fn kinds(mut self) -> Vec<Kind> {
        let mut kinds: BTreeMap<(String, String, String), Kind> = BTreeMap::new();
        let top = self.top;
        for (name, cell) in &top.cells {
            let types = self.types;
            let Some(arcs) = types.get(&cell.registers()) else { continue };
            for ((pin, bit), limit) in &arcs.ends {
                let arrival = cell.net(pin, *bit).and_then(|net| self.arrival(net));
                let Some((time, from)) = arrival else { continue };
                let is_register = cell.kind.starts_with("FD");
                let own = if is_register { cell.net("Q", 0).map(|net| self.name(net)) } else { None };
                let to = own.unwrap_or_else(|| name.clone());
                self.keep(&mut kinds, time + limit, from, to, format!("{}.{pin}", cell.kind));
            }
        }
        for (name, port) in top.ports.iter().filter(|(_, port)| port.direction == "output") {
            for net in port.bits.iter().filter_map(Bit::net) {
                if let Some((time, from)) = self.arrival(net) {
                    self.keep(&mut kinds, time, from, name.clone(), "output".into());
                }
            }
        }
        let mut kinds: Vec<Kind> = kinds.into_values().collect();
        kinds.sort_by(|a, b| b.delay_ps.cmp(&a.delay_ps).then_with(|| a.to.cmp(&b.to)));
        kinds
    }

    fn keep(
        &self,
        kinds: &mut BTreeMap<(String, String, String), Kind>,
        delay_ps: u64,
        from: u64,
        to: String,
        pin: String,
    ) {
        let kind = Kind { delay_ps, from: self.name(from), to, pin };
        let key = (without_numbers(&kind.from), without_numbers(&kind.to), kind.pin.clone());
        let known = kinds.entry(key).or_insert_with(|| kind.clone());
        if known.delay_ps < kind.delay_ps {
            *known = kind;
        }
    }

    fn name(&self, net: u64) -> String {
        self.names.get(&net).map_or_else(|| format!("net {net}"), |(name, _)| name.clone())
    }
}

fn without_numbers(name: &str) -> String {
    name.chars().filter(|letter| !letter.is_ascii_digit()).collect()
}

impl Cell {
    fn net(&self, pin: &str, bit: usize) -> Option<u64> {
        self.connections.get(pin)?.get(bit)?.net()
    }
}
