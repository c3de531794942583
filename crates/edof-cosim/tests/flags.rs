//! Bits that are set under conditions, and signs that are copied upwards: rust-hdl's own simulation, Icarus and Verilator agree, and the text is one
//! assignment.

use crate::kernels::agree;
use crate::testbench::{Random, emit};
use edof_verilog::describe::Circuit;
use rust_hdl::core::simulate::simulate;
use rust_hdl::prelude::*;

/// Words with flags beside a number, and one whose flag lies on the number.
#[derive(Circuit)]
#[circuit(registers(clock))]
struct Flags {
    pub clock: Signal<In, Clock>,
    pub number: Signal<In, Bits<4>>,
    pub first: Signal<In, Bit>,
    pub last: Signal<In, Bit>,
    pub word: Signal<Out, Bits<12>>,
    pub alone: Signal<Out, Bits<3>>,
    pub over: Signal<Out, Bits<6>>,
    pub extended: Signal<Out, Bits<8>>,
    pub is_empty: Signal<Out, Bit>,
    pub shifted: Signal<Out, Bits<8>>,
    beside: Signal<Local, Bits<12>>,
    only: Signal<Local, Bits<3>>,
    mixed: Signal<Local, Bits<6>>,
    wide: Signal<Local, Bits<8>>,
    shift: DFF<Bits<8>>,
}

impl Logic for Flags {
    #[hdl_gen]
    fn update(&mut self) {
        self.beside.next = bit_cast::<12, 4>(self.number.val()) << 2;
        if self.first.val() {
            self.beside.next = self.beside.val() | 0x400;
        }
        if self.last.val() {
            self.beside.next = self.beside.val() | 0x800;
        }
        self.only.next = 0.into();
        if self.first.val() && self.last.val() {
            self.only.next = 2.into();
        }
        self.mixed.next = bit_cast::<6, 4>(self.number.val());
        if self.first.val() {
            self.mixed.next = self.mixed.val() | 8;
        }
        self.wide.next = bit_cast::<8, 4>(self.number.val());
        if self.number.val().get_bit(3) {
            self.wide.next = self.wide.val() | 0xf0;
        }
        self.shift.d.next = bit_cast::<8, 4>(self.number.val()) << 1;
        if self.last.val() {
            self.shift.d.next = (bit_cast::<8, 4>(self.number.val()) << 1) | 1;
        }
        self.word.next = self.beside.val();
        self.alone.next = self.only.val();
        self.over.next = self.mixed.val();
        self.extended.next = self.wide.val();
        self.is_empty.next = !self.number.val().any();
        self.shifted.next = self.shift.q.val();
    }
}

#[test]
fn flags_and_signs_agree_cycle_by_cycle() {
    let emitted = emit(&mut Flags::default());
    let rows = Random(5).rows(&emitted, 300);
    let mut circuit = Flags::default();
    circuit.connect_all();
    let mut cycle = |row: &Vec<u128>| {
        circuit.number.next = (row[0] as u64).into();
        circuit.first.next = row[1] == 1;
        circuit.last.next = row[2] == 1;
        assert!(simulate(&mut circuit, 20));
        let outputs = vec![
            circuit.word.val().to_u128(),
            circuit.alone.val().to_u128(),
            circuit.over.val().to_u128(),
            circuit.extended.val().to_u128(),
            circuit.is_empty.val().into(),
            circuit.shifted.val().to_u128(),
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
fn flags_stand_beside_what_they_mark() {
    let text = &emit(&mut Flags::default()).modules[0].text;
    for words in [
        "{last_i, first_i, 4'd0, number_i, 2'd0}",
        "{1'b0, first_i && last_i, 1'b0}",
        "{{4{number_i[3]}}, number_i}",
        "number_i == 4'd0",
        "shift_q <= {3'd0, number_i, last_i};",
        "wire [5:0] mixed = first_i ? ({2'd0, number_i} | 6'd8) : {2'd0, number_i};",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    assert!(!text.contains("always @*"), "{text}");
}
