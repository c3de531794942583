//! Leaves of an ECP5's own cells, and weight memories as they are mapped to it: the same words in the same cycles as the portable text. Mistakes
//! that are put into them are found.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::verilator::{Library, Options, Start};
use edof_cosim::yosys::{self, ecp5};
use edof_cosim::{Port, Source};
use edof_device::board::ULX3S;
use edof_hdl::leaves::LEAVES;
use std::fmt::Write;
use std::path::Path;

/// Cycles in which everything that was unknown at the start has gone.
const SETTLED: usize = 16;
const CYCLES: usize = 20_000;

/// What the output ports are in every cycle once it has settled.
fn trace(source: &Source, memory_dir: Option<&Path>, inputs: &[Vec<u64>]) -> Vec<Vec<u64>> {
    let library = Library::build(source, &Options { optimize: 0, ..support::options() }).unwrap();
    let start = Start { memory_dir: memory_dir.map(Into::into), ..Start::default() };
    let mut model = library.start(&start).unwrap();
    let outputs = inputs[0].len() + 1..source.ports.len();
    let mut cycle = |row: &Vec<u64>| {
        (1..).zip(row).for_each(|(port, value)| model.poke(port, *value).unwrap());
        model.tick().unwrap();
        outputs.clone().map(|port| model.peek(port).unwrap()).collect()
    };
    inputs.iter().map(&mut cycle).collect::<Vec<_>>().split_off(SETTLED)
}

/// A number of so many bits: each fourth is the least or the greatest.
fn word(draw: &mut Draw, bits: u32) -> u64 {
    let (low, high) = (-(1i64 << (bits - 1)), (1i64 << (bits - 1)) - 1);
    let number = match draw.whole(0, 7) {
        0 => low,
        1 => high,
        _ => draw.whole(low, high),
    };
    number as u64
}

/// A leaf of `rtl/`: its name, its ports behind the clock, and its inputs in each cycle.
struct Leaf {
    name: &'static str,
    ports: Vec<Port>,
    inputs: Vec<Vec<u64>>,
}

impl Leaf {
    fn source(&self, text: &str) -> Source {
        let ports = std::iter::once(Port::clock("clock_i")).chain(self.ports.clone()).collect();
        Source { top: self.name.into(), files: vec![(format!("{}.v", self.name), text.into())], ports }
    }

    /// The portable text, and that of the part.
    fn texts(&self) -> [&'static str; 2] {
        let of = |leaves: &[(&str, &'static str)]| leaves.iter().find(|leaf| leaf.0 == self.name).unwrap().1;
        [of(LEAVES), of(ULX3S.part.leaves)]
    }

    fn own(&self, text: &str) -> Vec<Vec<u64>> {
        trace(&ecp5::with_cells(self.source(text)).unwrap(), None, &self.inputs)
    }
}

fn macc() -> Leaf {
    let inputs =
        [("first_i", 1), ("weight_i", 16), ("value_i", 25)].map(|(name, bits)| Port::input(name, bits));
    let draw = &mut Draw::new(1);
    // A value has 18 bits, and its sign above them.
    let row = |cycle| {
        vec![
            u64::from(cycle < 8 || draw.whole(0, 15) == 0),
            word(draw, 16) & 0xffff,
            word(draw, 18) & 0x1ff_ffff,
        ]
    };
    Leaf {
        name: "edof_macc",
        ports: inputs.into_iter().chain([Port::output("sum_o", 48)]).collect(),
        inputs: (0..CYCLES).map(row).collect(),
    }
}

fn scale() -> Leaf {
    let inputs =
        [("value_i", 18), ("factor_i", 18), ("addend_i", 48)].map(|(name, bits)| Port::input(name, bits));
    let draw = &mut Draw::new(2);
    let row = |_| [18, 18, 48].map(|bits| word(draw, bits) & ((1 << bits) - 1)).to_vec();
    Leaf {
        name: "edof_scale",
        ports: inputs.into_iter().chain([Port::output("sum_o", 48)]).collect(),
        inputs: (0..CYCLES).map(row).collect(),
    }
}

#[test]
fn leaves_of_its_own_cells_compute_what_the_portable_ones_do() {
    for leaf in [macc(), scale()] {
        let [portable, own] = leaf.texts();
        let expected = trace(&leaf.source(portable), None, &leaf.inputs);
        assert_eq!(leaf.own(own), expected, "{}", leaf.name);
        assert!(expected.iter().any(|row| row[0] >> 40 & 0xff == 0xff), "no sum is negative");
    }
}

/// What pads show in both halves of each cycle.
fn halves(source: &Source, inputs: &[[u64; 2]]) -> Vec<[u64; 2]> {
    let library = Library::build(source, &support::options()).unwrap();
    let mut model = library.start(&Start::default()).unwrap();
    let pins = source.port("pins_o").unwrap();
    let mut cycle = |pair: &[u64; 2]| {
        (1..).zip(pair).for_each(|(port, value)| model.poke(port, *value).unwrap());
        model.tick().unwrap();
        [model.peek_high(pins).unwrap(), model.peek(pins).unwrap()]
    };
    inputs.iter().map(&mut cycle).collect::<Vec<_>>().split_off(SETTLED)
}

#[test]
fn pads_show_two_bits_per_cycle_as_the_portable_leaf_does() {
    let ports = [Port::input("first_i", 4), Port::input("second_i", 4), Port::output("pins_o", 4)];
    let draw = &mut Draw::new(5);
    let inputs: Vec<[u64; 2]> = (0..2_000).map(|_| [0; 2].map(|_: u64| draw.whole(0, 15) as u64)).collect();
    let leaf = Leaf { name: "edof_ddr_out", ports: ports.into(), inputs: vec![] };
    let [portable, own] = leaf.texts().map(|text| text.replace("WIDTH = 1", "WIDTH = 4"));
    let found = halves(&ecp5::with_cells(leaf.source(&own)).unwrap(), &inputs);
    assert_eq!(halves(&leaf.source(&portable), &inputs), found);
    // A pair leaves from its third edge on.
    assert_eq!(found, inputs[SETTLED - 2..inputs.len() - 2]);
    let swapped = own.replace(".D0(first_i[pin])", ".D0(second_i[pin])");
    assert_ne!(halves(&ecp5::with_cells(leaf.source(&swapped)).unwrap(), &inputs), found);
}

#[test]
fn mistakes_in_a_leaf_are_found() {
    let leaf = macc();
    let [portable, own] = leaf.texts();
    let expected = trace(&leaf.source(portable), None, &leaf.inputs);
    for (right, wrong) in [
        (".INIT0(16'hA6AA)", ".INIT0(16'h66AA)"),
        ("{12{product[35]}}", "12'd0"),
        ("value_i[17:0]", "{value_i[16], value_i[16:0]}"),
    ] {
        assert!(own.contains(right), "{right}");
        assert_ne!(leaf.own(&own.replace(right, wrong)), expected, "{wrong}");
    }
}

/// Rows of a bank's memory: more than two block RAMs that lie under each other, the last one not full.
const DEPTH: usize = 1100;

/// A bank of one row, with a memory image.
fn bank() -> Source {
    let lanes = LEAVES.iter().find(|leaf| leaf.0 == "edof_macc_bank").unwrap().1;
    let input = |(name, bits): (&str, usize)| Port::input(name, bits);
    let output = |(name, bits): (&str, usize)| Port::output(name, bits);
    let inputs = INPUTS.map(input);
    let outputs = [("drain_even_o", 40), ("drain_odd_o", 40), ("back_o", 64)].map(output);
    let ports: Vec<Port> = std::iter::once(Port::clock("clock_i")).chain(inputs).chain(outputs).collect();
    let (mut declared, mut connected) = (vec![], vec![]);
    for port in &ports {
        let direction = if port.name.ends_with("_o") { "output" } else { "input" };
        declared.push(format!("{direction} wire [{}:0] {}", port.bits - 1, port.name));
        connected.push(format!(".{0}({0})", port.name));
    }
    let top = format!(
        "module bank ({});\n    edof_macc_bank #(.DEPTH({DEPTH}), .SUM(40), .INIT(\"bank\")) lanes ({}, .address_b_i(11'd0));\nendmodule\n",
        declared.join(", "),
        connected.join(", ")
    );
    let files = [("bank.v".into(), top), ("edof_macc_bank.v".into(), lanes.into())];
    Source { top: "bank".into(), files: files.into(), ports }
}

const INPUTS: [(&str, usize); 14] = [
    ("first_i", 1),
    ("address_a_i", 11),
    ("value_i", 25),
    ("copy_i", 1),
    ("shift_i", 1),
    ("drain_even_i", 40),
    ("drain_odd_i", 40),
    ("back_i", 1),
    ("read_i", 1),
    ("write_i", 1),
    ("write_bank_i", 6),
    ("write_half_i", 1),
    ("write_address_i", 12),
    ("write_data_q_i", 32),
];

/// What a stage and the host ask of a bank, without a read of a row in the cycle of its write, which an ECP5 leaves open.
fn asked() -> Vec<Vec<u64>> {
    let draw = &mut Draw::new(3);
    let row = |cycle: usize| {
        let mut whole = |most: usize| draw.whole(0, most as i64) as u64;
        let often = |chance: u64| u64::from(chance == 0);
        let (first, copy, shift) = (whole(15), whole(15), whole(3));
        let (address, write_address, host) = (whole(DEPTH - 1), whole(DEPTH - 1), whole(3));
        let write = host == 0 && address != write_address;
        let [bank, half, back] = [whole(7) / 7, whole(1), whole(1)];
        let [even, odd, data] =
            [draw.bits() & 0xff_ffff_ffff, draw.bits() & 0xff_ffff_ffff, draw.bits() & 0xffff_ffff];
        let value = word(draw, 18) & 0x1ff_ffff;
        let starts = if cycle < SETTLED { 1 } else { often(first) };
        let (write, read) = (u64::from(write), u64::from(host == 1));
        vec![
            starts,
            address,
            value,
            often(copy),
            often(shift),
            even,
            odd,
            back,
            read,
            write,
            bank,
            half,
            write_address,
            data,
        ]
    };
    (0..CYCLES / 4).map(row).collect()
}

/// The image of the bank's memory.
fn image() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("mem")).unwrap();
    let draw = &mut Draw::new(4);
    let words = (0..DEPTH).fold(String::new(), |mut text, _| {
        writeln!(text, "{:016x}", draw.bits()).unwrap();
        text
    });
    std::fs::write(dir.path().join("mem/bank00_0.mem"), words).unwrap();
    dir
}

/// What the bank gives as it is mapped by such commands and maps.
fn as_mapped(images: &Path, synthesis: &[(&str, &str)]) -> Vec<Vec<u64>> {
    let part = bank().files.into_iter().chain([("edof_macc.v".into(), macc().texts()[1].into())]).collect();
    let options = yosys::Options { memory_dir: Some(images.into()), ..yosys::Options::default() };
    let netlist = ecp5::mapped(&Source { files: part, ..bank() }, &options, synthesis).unwrap();
    let text = &netlist.files[0].1;
    let count = |cell: &str| text.matches(cell).count();
    assert_eq!((count("PDPW16KD #("), count("MULT18X18D #(")), (6, 4), "{}", text.len());
    trace(&netlist, None, &asked())
}

#[test]
fn weights_in_block_rams_with_their_own_registers_come_when_the_text_says() {
    let images = image();
    let portable =
        bank().files.into_iter().chain([("edof_macc.v".into(), macc().texts()[0].into())]).collect();
    let expected = trace(&Source { files: portable, ..bank() }, Some(images.path()), &asked());
    assert!(expected.iter().filter(|row| row[2] != 0).count() > 100, "hardly anything is read back");
    assert_eq!(as_mapped(images.path(), &ecp5::SYNTHESIS), expected);
    let [commands, (name, map), tables, register] = ecp5::SYNTHESIS;
    let as_wrongly_mapped = |map: &str| as_mapped(images.path(), &[commands, (name, map), tables, register]);
    for (right, wrong) in [
        (".REGMODE(\"OUTREG\")", ".REGMODE(\"NOREG\")"),
        ("RD_DATA = block_q2[1] ?", "RD_DATA = block_q[1] ?"),
        ("row = 512 * block + 8 * eight + i", "row = 512 * block + 8 * eight + (i ^ 1)"),
        ("WR_EN[32*half]", "WR_EN[0]"),
    ] {
        assert!(map.contains(right), "{right}");
        assert_ne!(as_wrongly_mapped(&map.replace(right, wrong)), expected, "{wrong}");
    }
    // Halves of a word as they come in.
    let swap =
        |map: String, bit: usize| map.replace(&format!(".DO{bit}("), &format!(".DO~{}(", (bit + 18) % 36));
    let straight = (0..36).fold(map.to_owned(), swap).replace('~', "");
    assert!(straight.contains(".DO0(found[block][32*half+0])"));
    assert_ne!(as_wrongly_mapped(&straight), expected);
}

/// A table of the display, with a memory image in a folder.
struct Table {
    width: usize,
    depth: usize,
    images: tempfile::TempDir,
}

impl Table {
    fn new(width: usize, depth: usize) -> Self {
        let images = tempfile::tempdir().unwrap();
        std::fs::create_dir(images.path().join("mem")).unwrap();
        let draw = &mut Draw::new(6);
        let rows: String = (0..depth).map(|_| format!("{:x}\n", draw.bits() >> (64 - width))).collect();
        std::fs::write(images.path().join("mem/table"), rows).unwrap();
        Self { width, depth, images }
    }

    fn source(&self) -> Source {
        let (width, depth) = (self.width, self.depth);
        let inputs =
            [("read_address_i", 16), ("write_enable_i", 1), ("address_i", 16), ("write_data_i", width)];
        let outputs = [("read_data_o", width), ("data_o", width)];
        let ports: Vec<Port> = std::iter::once(Port::clock("clock_i"))
            .chain(inputs.map(|(name, bits)| Port::input(name, bits)))
            .chain(outputs.map(|(name, bits)| Port::output(name, bits)))
            .collect();
        let declared = ports.iter().map(|port| {
            let direction = if port.name.ends_with("_o") { "output" } else { "input" };
            format!("{direction} wire [{}:0] {}", port.bits - 1, port.name)
        });
        let connected = ports.iter().map(|port| format!(".{0}({0})", port.name));
        let [declared, connected] =
            [declared.collect::<Vec<_>>(), connected.collect()].map(|list| list.join(", "));
        let top = format!(
            "module top ({declared});\n    edof_table #(.WIDTH({width}), .DEPTH({depth}), .INIT(\"table\")) colours ({connected});\nendmodule\n"
        );
        let leaf = LEAVES.iter().find(|leaf| leaf.0 == "edof_table").unwrap().1;
        let files = [("top.v".into(), top), ("edof_table.v".into(), leaf.into())];
        Source { top: "top".into(), files: files.into(), ports }
    }

    /// What is read, looked at and written: each fourth address is one of both ends of both halves, and no row is read in the cycle of its write.
    fn asked(&self) -> Vec<Vec<u64>> {
        let draw = &mut Draw::new(7);
        let last = self.depth - 1;
        let ends = [0, 1, 16_383.min(last), 16_384.min(last), last];
        let row = |_| {
            let mut address = || match draw.whole(0, 3) {
                0 => ends[draw.whole(0, 4) as usize] as u64,
                _ => draw.whole(0, last as i64) as u64,
            };
            let (read, looked) = (address(), address());
            let write = read != looked && draw.whole(0, 1) == 0;
            vec![read, u64::from(write), looked, draw.bits() >> (64 - self.width)]
        };
        (0..CYCLES).map(row).collect()
    }

    fn as_mapped(&self, synthesis: &[(&str, &str)]) -> Vec<Vec<u64>> {
        let options =
            yosys::Options { memory_dir: Some(self.images.path().into()), ..yosys::Options::default() };
        let netlist = ecp5::mapped(&self.source(), &options, synthesis).unwrap();
        let blocks = netlist.files[0].1.matches("DP16KD #(").count();
        assert_eq!(blocks, self.width * self.depth.div_ceil(16_384));
        trace(&netlist, None, &self.asked())
    }
}

#[test]
fn tables_take_one_block_ram_for_both_ports_and_come_when_the_text_says() {
    for table in [Table::new(3, 16_384), Table::new(2, 32_768)] {
        let expected = trace(&table.source(), Some(table.images.path()), &table.asked());
        assert_eq!(table.as_mapped(&ecp5::SYNTHESIS), expected, "{} bits", table.width);
    }
    let table = Table::new(2, 32_768);
    let expected = trace(&table.source(), Some(table.images.path()), &table.asked());
    let [commands, weights, (name, map), register] = ecp5::SYNTHESIS;
    for (right, wrong) in [
        ("row / 8 % 2", "row / 8 % 1"),
        ("64*half", "0*half"),
        ("seen[looked_q[1]]", "seen[looked_q[0]]"),
        ("HALVES == 1 || looked[14] == half", "1"),
        ("wire [14:0] read = RD_ADDR[(1-LOOKS)*ABITS", "wire [14:0] read = RD_ADDR[LOOKS*ABITS"),
    ] {
        assert!(map.contains(right), "{right}");
        let map = map.replace(right, wrong);
        let found = table.as_mapped(&[commands, weights, (name, &map), register]);
        assert_ne!(found, expected, "{wrong}");
    }
}
