//! Names of elements, values in place of names, formulas, and comparisons one after the other: rust-hdl's own simulation, Icarus and Verilator agree,
//! and the text reads as it should.

use crate::kernels::agree;
use crate::testbench::{Random, emit};
use edof_verilog::describe::Circuit;
use rust_hdl::core::simulate::simulate;
use rust_hdl::prelude::*;

/// Names of the words.
const WORDS: [&str; 3] = ["id", "status", "scratch"];

/// A map of three registers, read at the clock's edge, and a table of four numbers.
#[derive(Circuit)]
#[circuit(registers(clock))]
struct Map {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub write: Signal<In, Bit>,
    pub address: Signal<In, Bits<4>>,
    pub word: Signal<In, Bits<8>>,
    pub status: Signal<In, Bits<8>>,
    pub read: Signal<Out, Bits<8>>,
    pub known: Signal<Out, Bit>,
    pub late: Signal<Out, Bit>,
    pub entry: Signal<Out, Bits<8>>,
    #[names(_words)]
    addr: [Constant<Bits<4>>; 3],
    #[literal]
    masks: [Constant<Bits<8>>; 3],
    #[signed]
    offset: Constant<Bits<8>>,
    clock_hz: Constant<Bits<32>>,
    #[is(clock_hz / 1000 - 2)]
    time_out: Constant<Bits<8>>,
    #[is(time_out / 20 + 1)]
    other: Constant<Bits<8>>,
    _words: [&'static str; 3],
    #[names(_words)]
    value: [Signal<Local, Bits<8>>; 3],
    scratch: DFF<Bits<8>>,
    read_q: DFF<Bits<8>>,
    known_q: DFF<Bit>,
    wait_count: DFF<Bits<8>>,
}

impl Default for Map {
    fn default() -> Self {
        let number = |value: u64| Constant::new(value.into());
        Self::from_parts(MapParts {
            addr: [0, 3, 9].map(|word: u64| Constant::new(word.into())),
            masks: [0xff, 0x3c, 0xff].map(|mask: u64| Constant::new(mask.into())),
            offset: number(0xfb),
            clock_hz: Constant::new(100_000_u64.into()),
            _words: WORDS,
        })
    }
}

impl Logic for Map {
    #[hdl_gen]
    fn update(&mut self) {
        self.value[0].next = 0x5a.into();
        self.value[1].next = self.status.val() + self.offset.val();
        self.value[2].next = self.scratch.q.val();
        self.read_q.d.next = 0.into();
        self.known_q.d.next = false;
        for i in 0..3 {
            if self.address.val() == self.addr[i].val() {
                self.read_q.d.next = self.value[i].val() & self.masks[i].val();
                self.known_q.d.next = self.write.val();
            }
        }
        if self.write.val() && (self.address.val() == self.addr[2].val()) {
            self.scratch.d.next = self.word.val();
        }
        self.wait_count.d.next = self.wait_count.q.val() + self.other.val();
        if self.write.val() {
            self.wait_count.d.next = 0.into();
        }
        // Four numbers of two bits: the last is what is left.
        self.entry.next = 0.into();
        if self.address.val().get_bits::<2>(0) == 0 {
            self.entry.next = self.word.val();
        }
        if self.address.val().get_bits::<2>(0) == 2 {
            self.entry.next = self.status.val();
        }
        if self.address.val().get_bits::<2>(0) == 1 {
            self.entry.next = 7.into();
        }
        if self.address.val().get_bits::<2>(0) == 3 {
            self.entry.next = self.word.val() ^ self.status.val();
        }
        if self.reset.val() {
            self.scratch.d.next = 0.into();
            self.wait_count.d.next = 0.into();
            self.read_q.d.next = 0.into();
            self.known_q.d.next = false;
        }
        self.read.next = self.read_q.q.val();
        self.known.next = self.known_q.q.val();
        self.late.next = self.wait_count.q.val() == self.time_out.val();
    }
}

#[test]
fn a_map_of_registers_agrees_cycle_by_cycle() {
    let emitted = emit(&mut Map::default());
    let mut rows = Random(3).rows(&emitted, 600);
    rows.iter_mut().enumerate().for_each(|(n, row)| row[0] = u128::from(n == 0 || n % 97 == 50));
    rows.iter_mut().for_each(|row| row[1] &= row[3] & 1);
    let mut circuit = Map::default();
    circuit.connect_all();
    let mut cycle = |row: &Vec<u128>| {
        circuit.reset.next = row[0] == 1;
        circuit.write.next = row[1] == 1;
        circuit.address.next = (row[2] as u64).into();
        circuit.word.next = (row[3] as u64).into();
        circuit.status.next = (row[4] as u64).into();
        assert!(simulate(&mut circuit, 20));
        let outputs = vec![
            circuit.read.val().to_u128(),
            circuit.known.val().into(),
            circuit.late.val().into(),
            circuit.entry.val().to_u128(),
        ];
        for edge in [true, false] {
            circuit.clock.next = edge.into();
            assert!(simulate(&mut circuit, 20));
        }
        outputs
    };
    let want: Vec<_> = rows.iter().map(&mut cycle).collect();
    agree(&emitted, &rows, &want);
}

#[test]
fn a_map_of_registers_reads_as_a_case() {
    let text = &emit(&mut Map::default()).modules[0].text;
    for words in [
        "localparam [3:0] ADDR_ID = 4'd0, ADDR_STATUS = 4'd3, ADDR_SCRATCH = 4'd9;",
        "localparam [7:0] OFFSET = -8'sd5;",
        "localparam CLOCK_HZ = 100_000;",
        "localparam [31:0] TIME_OUT = CLOCK_HZ / 1000 - 2, OTHER = TIME_OUT / 20 + 1;",
        "assign late_o = wait_count_q == TIME_OUT[7:0];",
        "    known_q <= write_i;\n    case (address_i)\n",
        "      ADDR_STATUS: read_q <= value_status & 8'h3c;\n      ADDR_SCRATCH: read_q <= scratch_q;\n",
        "      default: known_q <= 1'b0;\n",
        "      2'd1: entry_o = 8'd7;\n      default: entry_o = word_i ^ status_i;\n",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
}
