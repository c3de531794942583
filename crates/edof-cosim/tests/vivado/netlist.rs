//! What the stub of Vivado (sim/vivado/commands.tcl) must know of a design, from Yosys: ports, registers with their clocks, and every way from
//! one clock to another in the optimised netlist. A register that two merged ones became appears under both names: a tool may keep either.

use crate::board::{run, said};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

/// A file of `write_json`.
#[derive(Deserialize)]
struct Json {
    modules: BTreeMap<String, Module>,
}

#[derive(Deserialize)]
struct Module {
    #[serde(default)]
    ports: BTreeMap<String, Port>,
    #[serde(default)]
    cells: BTreeMap<String, Cell>,
    #[serde(default)]
    netnames: BTreeMap<String, Wire>,
    #[serde(default)]
    parameter_default_values: BTreeMap<String, String>,
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
    attributes: BTreeMap<String, String>,
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

/// A net, or a constant.
#[derive(Deserialize, Clone)]
#[serde(untagged)]
enum Bit {
    Net(usize),
    Constant(#[allow(dead_code)] String),
}

impl Bit {
    fn net(&self) -> Option<usize> {
        match self {
            Self::Net(net) => Some(*net),
            Self::Constant(_) => None,
        }
    }
}

impl Cell {
    fn is_flip_flop(&self) -> bool {
        ["$_DFF", "$_SDFF", "$_ALDFF"].iter().any(|kind| self.kind.starts_with(kind))
    }

    /// Whether its set or reset acts without a clock: `$_DFF_PP1_`, `$_DFFE_PP1P_` and the like.
    fn is_asynchronous(&self) -> bool {
        let letters = self.kind.split('_').nth(2).map_or(0, str::len);
        (self.kind.starts_with("$_DFF_") && letters == 3)
            || (self.kind.starts_with("$_DFFE_") && letters == 4)
            || ["$_ALDFF", "$_DFFSR"].iter().any(|kind| self.kind.starts_with(kind))
    }

    fn is_memory(&self) -> bool {
        self.kind.starts_with("$mem")
    }

    /// A buffer of a clock or of a pad: nothing but a wire.
    fn is_buffer(&self) -> bool {
        ["BUFG", "IBUF", "IBUFDS", "IBUFGDS", "OBUF"].contains(&self.kind.as_str())
    }

    /// Logic between registers; what is no cell of Yosys' own is a primitive or a black box.
    fn is_logic(&self) -> bool {
        self.kind.starts_with('$') && !self.is_flip_flop() && !self.is_memory()
    }

    fn bits(&self, port: &str) -> impl Iterator<Item = usize> + '_ {
        self.connections.get(port).into_iter().flatten().filter_map(Bit::net)
    }

    fn inputs(&self) -> impl Iterator<Item = usize> + '_ {
        let is_input = |port: &&String| self.port_directions.get(*port).is_some_and(|d| d == "input");
        self.connections.keys().filter(is_input).flat_map(|port| self.bits(port))
    }
}

/// What drives a net.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Driver {
    None,
    /// A bit of a port of the top: an index of `ports`.
    Port(usize),
    /// A cell.
    Cell(usize),
}

/// A netlist as Tcl commands for the stub, and what no synthesiser should meet.
pub struct Objects {
    /// The commands.
    pub tcl: String,
    /// Asynchronous sets and resets with logic before them.
    pub glitches: Vec<String>,
}

struct Flat<'a> {
    cells: Vec<(&'a String, &'a Cell)>,
    ports: Vec<(String, &'a str, usize)>,
    driver: Vec<Driver>,
    /// Pin of the cell that drives a net, for primitives.
    pin: Vec<Option<&'a str>>,
    /// Public names of each net that a register has, as Vivado names the register.
    names: BTreeMap<usize, BTreeSet<String>>,
    in_pads: BTreeSet<usize>,
}

const YOSYS: &str = "read_verilog -lib +/xilinx/cells_sim.v +/xilinx/cells_xtra.v constraints/mig_kc705.v
read_verilog -defer @RTL@
hierarchy -check -top kc705_top
@BOX@
hierarchy -top kc705_top
proc
write_json @OUT@.parts
flatten
opt -fine
memory_collect
simplemap t:$dff t:$adff t:$dffe t:$adffe t:$sdff t:$sdffe t:$sdffce
opt_expr
opt_merge
opt_clean
write_json @OUT@
";

/// The objects of a generated directory. Modules of `boxes` are left out: each is in one clock alone.
pub fn objects(folder: &Path, boxes: &[&str]) -> Objects {
    let sources = sources(folder);
    let paths: Vec<String> = sources.keys().map(|name| format!("rtl/{name}.v")).collect();
    let out = folder.join("netlist.json");
    let boxes: String = boxes.iter().map(|module| format!("blackbox ={module}\n")).collect();
    let script = YOSYS
        .replace("@RTL@", &paths.join(" "))
        .replace("@BOX@", &boxes)
        .replace("@OUT@", &out.display().to_string());
    fs::write(folder.join("netlist.ys"), script).unwrap();
    let run = run("yosys", &["-q", "netlist.ys"], folder);
    assert!(run.status.success(), "{}", said(&run));
    let read =
        |path: &Path| -> Json { serde_json::from_reader(BufReader::new(File::open(path).unwrap())).unwrap() };
    let parts = read(&folder.join("netlist.json.parts"));
    let flat = read(&out);
    let mut tcl = String::new();
    instances(&parts, &parts.modules["kc705_top"], "", &mut tcl);
    images(&parts, folder, &mut tcl);
    let mut vectors = BTreeSet::new();
    vectors_below(&parts, "kc705_top", "", &sources, &mut vectors);
    let netlist = Flat::of(&flat.modules["kc705_top"], &vectors);
    let glitches = netlist.write(&mut tcl);
    Objects { tcl, glitches }
}

/// Every module's text by its name.
fn sources(folder: &Path) -> BTreeMap<String, String> {
    let files = fs::read_dir(folder.join("rtl")).unwrap().map(|entry| entry.unwrap().path());
    files
        .map(|path| (path.file_stem().unwrap().to_str().unwrap().into(), fs::read_to_string(&path).unwrap()))
        .collect()
}

/// `edof_ram` of `$paramod$0123\edof_ram`, or of `$paramod\edof_ram\WIDTH=…`.
fn module_name(kind: &str) -> &str {
    if kind.starts_with("$paramod$") {
        kind.rsplit('\\').next().unwrap()
    } else if let Some(rest) = kind.strip_prefix("$paramod\\") {
        rest.split('\\').next().unwrap()
    } else {
        kind
    }
}

fn below(path: &str, name: &str) -> String {
    let name = name.replace('.', "/");
    if path.is_empty() { name } else { format!("{path}/{name}") }
}

/// Every instance with its module; the pins of primitives.
fn instances(json: &Json, module: &Module, path: &str, tcl: &mut String) {
    for (name, cell) in module.cells.iter().filter(|(name, _)| !name.starts_with('$')) {
        let at = below(path, name);
        let kind = module_name(&cell.kind);
        writeln!(tcl, "cell {{{at}}} {kind}").unwrap();
        if path.is_empty() && kind != "kc705_core" {
            for pin in cell.connections.keys() {
                writeln!(tcl, "pin {{{at}/{pin}}}").unwrap();
            }
        }
        if let Some(part) = json.modules.get(&cell.kind) {
            instances(json, part, &at, tcl);
        }
    }
}

/// Every image that a memory of the design reads, with as many words as the memory has.
fn images(json: &Json, folder: &Path, tcl: &mut String) {
    let mut found = BTreeMap::new();
    for (kind, module) in &json.modules {
        let text = |name: &str| module.parameter_default_values.get(name).map_or("", |v| v.trim_end());
        let number = |name: &str| usize::from_str_radix(text(name), 2).unwrap_or(0);
        match module_name(kind) {
            _ if text("INIT").is_empty() => {}
            "edof_start" => _ = found.insert(text("INIT").to_owned(), 2),
            "edof_macc_bank" => {
                let parts = if number("DENSE") == 0 { 1 } else { number("ROWS") };
                let name = |part| format!("{}{:02}_{part}.mem", text("INIT"), number("BANK"));
                found.extend((0..parts).map(|part| (name(part), number("DEPTH"))));
            }
            leaf if leaf.starts_with("edof_") && number("DEPTH") > 0 && text("INIT").ends_with(".mem") => {
                _ = found.insert(text("INIT").to_owned(), number("DEPTH"));
            }
            _ => {}
        }
    }
    // Where the calculator is left out, its images are taken from the directory: every one is read by something.
    for entry in fs::read_dir(folder.join("mem")).unwrap() {
        let entry = entry.unwrap();
        let words = || fs::read_to_string(entry.path()).unwrap().lines().count();
        found.entry(entry.file_name().into_string().unwrap()).or_insert_with(words);
    }
    for (name, words) in found {
        writeln!(tcl, "image {name} {words}").unwrap();
    }
}

/// Paths of signals of one bit that are vectors nevertheless, and so have an index in their registers' names.
fn vectors_below(
    json: &Json,
    kind: &str,
    path: &str,
    sources: &BTreeMap<String, String>,
    all: &mut BTreeSet<String>,
) {
    let Some(module) = json.modules.get(kind) else { return };
    let Some(text) = sources.get(module_name(kind)) else { return };
    for declared in text.split(['\n', ';']).map(str::trim) {
        let is_net =
            ["reg [", "wire [", "input", "output", "(*"].iter().any(|start| declared.starts_with(start));
        // A range holds for the names that follow, until the next declaration in the row.
        let mut is_vector = false;
        for part in declared.split(',').filter(|_| is_net) {
            let (begins, name) = part.split_once("] ").map_or((false, part), |(_, name)| (true, name));
            is_vector = begins || (is_vector && !part.contains(" wire "));
            if let Some(name) = name.split(['=', '[']).next().filter(|_| is_vector) {
                all.insert(below(path, name.trim()));
            }
        }
    }
    for (name, cell) in module.cells.iter().filter(|(name, _)| !name.starts_with('$')) {
        vectors_below(json, &cell.kind, &below(path, name), sources, all);
    }
}

fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

impl<'a> Flat<'a> {
    fn of(top: &'a Module, vectors: &BTreeSet<String>) -> Self {
        let nets =
            top.netnames.values().flat_map(|wire| &wire.bits).filter_map(Bit::net).max().unwrap_or(0) + 1;
        let cells: Vec<_> = top.cells.iter().collect();
        let mut flat = Self {
            cells,
            ports: vec![],
            driver: vec![Driver::None; nets],
            pin: vec![None; nets],
            names: BTreeMap::new(),
            in_pads: BTreeSet::new(),
        };
        let indexed = |name: &str, wire: &[Bit], i: usize| {
            if wire.len() > 1 || vectors.contains(name) { format!("[{i}]") } else { String::new() }
        };
        for (name, port) in &top.ports {
            for (i, bit) in port.bits.iter().enumerate() {
                let net = bit.net().unwrap_or(usize::MAX);
                if port.direction != "output" && net < nets {
                    flat.driver[net] = Driver::Port(flat.ports.len());
                }
                flat.ports.push((format!("{name}{}", indexed(name, &port.bits, i)), &port.direction, net));
            }
        }
        for (index, (_, cell)) in flat.cells.iter().enumerate() {
            for (port, bits) in &cell.connections {
                if cell.port_directions.get(port).is_none_or(|d| d != "output") {
                    continue;
                }
                for net in bits.iter().filter_map(Bit::net).filter(|net| *net < nets) {
                    (flat.driver[net], flat.pin[net]) = (Driver::Cell(index), Some(port.as_str()));
                }
            }
        }
        for (name, wire) in top.netnames.iter().filter(|(_, wire)| wire.hide_name == 0) {
            let path = name.replace('.', "/");
            for (i, net) in wire.bits.iter().enumerate().filter_map(|(i, bit)| Some((i, bit.net()?))) {
                if wire.attributes.contains_key("IOB") {
                    flat.in_pads.insert(net);
                }
                if path.ends_with("_q") {
                    let register = format!("{path}_reg{}", indexed(&path, &wire.bits, i));
                    flat.names.entry(net).or_default().insert(register);
                }
            }
        }
        flat
    }

    /// The names of the register whose output is a net; one that nobody named has that of its cell.
    fn names_of(&self, index: usize) -> Vec<String> {
        let (name, cell) = self.cells[index];
        if cell.is_memory() {
            let id = cell.parameters.get("MEMID").map_or(name.as_str(), String::as_str);
            return vec![format!("{}_reg", id.trim_start_matches('\\').replace('.', "/"))];
        }
        let found = cell.bits("Q").next().and_then(|net| self.names.get(&net));
        found.map_or_else(|| vec![name.replace('.', "/")], |names| names.iter().cloned().collect())
    }

    /// Where a clock comes from: a port, or a pin of a primitive.
    fn clock(&self, mut net: usize) -> String {
        loop {
            match self.driver[net] {
                Driver::None => return "nothing".into(),
                Driver::Port(port) => return self.ports[port].0.clone(),
                Driver::Cell(index) => {
                    let (name, cell) = self.cells[index];
                    match cell.bits("I").next().filter(|_| cell.is_buffer()) {
                        Some(next) => net = next,
                        None => return format!("{}/{}", name.replace('.', "/"), self.pin[net].unwrap_or("")),
                    }
                }
            }
        }
    }

    fn clock_of(&self, index: usize) -> Option<String> {
        let cell = self.cells[index].1;
        let port = if cell.is_memory() { "WR_CLK" } else { "C" };
        cell.bits(port).next().map(|net| self.clock(net))
    }

    /// Registers and memories from which logic leads to a net, and whether there is any logic.
    fn sources(&self, net: usize) -> (BTreeSet<usize>, bool) {
        let (mut found, mut seen, mut waiting) = (BTreeSet::new(), BTreeSet::new(), vec![net]);
        let mut is_logic = false;
        while let Some(net) = waiting.pop() {
            let Driver::Cell(index) = self.driver[net] else { continue };
            let cell = self.cells[index].1;
            if cell.is_flip_flop() || cell.is_memory() {
                found.insert(index);
            }
            is_logic |= cell.is_logic();
            // Through logic and buffers, and from a memory's address to what it reads.
            let more: Vec<usize> = match () {
                () if cell.is_logic() || cell.is_buffer() => cell.inputs().collect(),
                () if cell.is_memory() => cell.bits("RD_ADDR").collect(),
                () => vec![],
            };
            if seen.insert(index) {
                waiting.extend(more);
            }
        }
        (found, is_logic)
    }

    fn write(&self, tcl: &mut String) -> Vec<String> {
        let line = |tcl: &mut String, words: std::fmt::Arguments<'_>| writeln!(tcl, "{words}").unwrap();
        self.write_ports(tcl);
        let clocks: Vec<Option<String>> = (0..self.cells.len())
            .map(|i| self.cells[i].1)
            .enumerate()
            .map(|(i, cell)| (cell.is_flip_flop() || cell.is_memory()).then(|| self.clock_of(i)).flatten())
            .collect();
        let (mut glitches, mut crossings, mut folders) = (vec![], vec![], BTreeSet::new());
        for (index, (name, cell)) in self.cells.iter().enumerate() {
            if !cell.kind.starts_with('$') {
                self.write_derived(name, cell, tcl);
            }
            let Some(clock) = &clocks[index] else { continue };
            // Next to every synchroniser, whatever feeds it.
            let synchronisers = self.names_of(index).into_iter().filter(|name| name.contains("/first_q_reg"));
            folders.extend(synchronisers.map(|name| folder(&name).to_owned()));
            let pins: &[&str] =
                if cell.is_memory() { &["WR_DATA", "WR_ADDR", "WR_EN"] } else { &["D", "E", "R"] };
            for pin in pins {
                let is_reset = *pin == "R" && cell.is_asynchronous();
                for net in cell.bits(pin) {
                    let (sources, is_logic) = self.sources(net);
                    if is_reset && is_logic {
                        glitches.push(self.names_of(index).join(" or "));
                    }
                    // Who asks for a reset is of no clock, whichever its register has.
                    let crosses =
                        |from: &usize| is_reset || clocks[*from].as_ref().is_some_and(|other| other != clock);
                    for from in sources.into_iter().filter(crosses) {
                        let end = if is_reset { "PRE" } else { "D" };
                        for (from, to) in self.names_of(from).iter().flat_map(|from| {
                            self.names_of(index).into_iter().map(move |to| (from.clone(), to))
                        }) {
                            folders.extend([folder(&from).to_owned(), folder(&to).to_owned()]);
                            crossings.push(format!("crossing {{{from}}} {{{to}/{end}}}"));
                        }
                    }
                }
            }
        }
        self.write_registers(&clocks, &folders, tcl);
        crossings.sort();
        crossings.dedup();
        crossings.iter().for_each(|crossing| line(tcl, format_args!("{crossing}")));
        glitches
    }

    /// Registers at the top and beside those of a crossing, and one more of every clock.
    fn write_registers(&self, clocks: &[Option<String>], folders: &BTreeSet<String>, tcl: &mut String) {
        let mut seen = BTreeSet::new();
        for (index, clock) in clocks.iter().enumerate().filter_map(|(i, clock)| Some((i, clock.as_ref()?))) {
            let is_first = seen.insert(clock);
            for register in self.names_of(index) {
                let at = folder(&register);
                if is_first || at.is_empty() || folders.contains(at) {
                    writeln!(tcl, "register {{{register}}} {{{clock}}}").unwrap();
                    self.write_pad(&register, self.cells[index].1, tcl);
                }
            }
        }
    }

    fn write_ports(&self, tcl: &mut String) {
        let mut loads = BTreeMap::<usize, BTreeSet<bool>>::new();
        for (_, cell) in &self.cells {
            let is_clock = cell.is_buffer() && cell.kind != "OBUF";
            cell.inputs().for_each(|net| _ = loads.entry(net).or_default().insert(is_clock));
        }
        for (name, direction, net) in &self.ports {
            writeln!(tcl, "port {{{name}}} {direction}").unwrap();
            if name.starts_with("ddr3_") {
                continue;
            }
            let is_read = *direction == "inout" || loads.get(net).is_some_and(|kinds| kinds.contains(&false));
            if *direction != "output" && is_read {
                writeln!(tcl, "input {{{name}}}").unwrap();
            }
            if *direction != "input" && *net != usize::MAX {
                writeln!(tcl, "output {{{name}}}").unwrap();
            }
        }
    }

    /// Clocks that a primitive makes of another.
    fn write_derived(&self, name: &str, cell: &Cell, tcl: &mut String) {
        let input = ["CLKIN1", "sys_clk_i"].into_iter().find_map(|pin| cell.bits(pin).next());
        let Some(from) = input.map(|net| self.clock(net)) else { return };
        let outputs = cell.connections.keys().filter(|pin| pin.starts_with("CLKOUT") || *pin == "ui_clk");
        for pin in outputs {
            writeln!(tcl, "derived {{{}/{pin}}} {{{from}}}", name.replace('.', "/")).unwrap();
        }
    }

    /// Whether a register asks for a pad, and the port that is there.
    fn write_pad(&self, register: &str, cell: &Cell, tcl: &mut String) {
        let (Some(q), d) = (cell.bits("Q").next(), cell.bits("D").next()) else { return };
        if !self.in_pads.contains(&q) {
            return;
        }
        let out = self.ports.iter().find(|(_, direction, net)| *direction == "output" && *net == q);
        let into = d.and_then(|net| match self.driver[net] {
            Driver::Port(port) => Some(&self.ports[port]),
            _ => None,
        });
        let port = out.or(into).map_or("", |(name, ..)| name);
        writeln!(tcl, "pad {{{register}}} {{{port}}}").unwrap();
    }
}
