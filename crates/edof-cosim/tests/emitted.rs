//! A circuit in Rust goes through the backend into both simulators.

use crate::support::build;
use edof_cosim::verilator::Start;
use edof_cosim::{Layout, Source, icarus, lint};
use edof_hdl::leaf::Leaf;
use edof_hdl::verilog;
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

/// Sums what comes in.
#[derive(Circuit)]
struct Summer {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub value: Signal<In, Bits<12>>,
    pub sum: Signal<Out, Bits<12>>,
    pub wrapped: Signal<Out, Bit>,
    total: DFF<Bits<12>>,
}

impl Logic for Summer {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, total);
        self.total.d.next = self.total.q.val() + self.value.val();
        if self.reset.val() {
            self.total.d.next = 0.into();
        }
        self.sum.next = self.total.q.val();
        self.wrapped.next = self.total.q.val() + 1 == 0;
    }
}

const STONE: &str =
    "module stone (input wire clock_i, output wire [3:0] data_o);\n    pebble part ();\nendmodule\n";

/// An instance of the leaf `stone`.
#[derive(Circuit)]
struct Stone {
    pub clock: Signal<In, Clock>,
    pub data: Signal<Out, Bits<4>>,
}

impl Logic for Stone {
    fn update(&mut self) {}
    fn connect(&mut self) {
        self.data.connect();
    }
    fn hdl(&self) -> Verilog {
        Leaf::new("stone", STONE).port("clock_i", "clock").port("data_o", "data").verilog()
    }
}

/// Holds a stone.
#[derive(Circuit)]
#[circuit(default)]
struct Holder {
    pub clock: Signal<In, Clock>,
    pub data: Signal<Out, Bits<4>>,
    stone: Stone,
}

impl Logic for Holder {
    #[hdl_gen]
    fn update(&mut self) {
        self.stone.clock.next = self.clock.val();
        self.data.next = self.stone.data.val();
    }
}

#[test]
fn a_printed_circuit_is_clean_and_the_same_in_both_simulators() {
    let mut summer = Summer::default();
    summer.connect_all();
    let source = Source::emitted(&verilog::emit(&summer).unwrap(), |_| None).unwrap();
    lint::clean(&source, None).unwrap();
    let mut rows = Layout::inputs(&source).random(500, 3);
    (0..500).for_each(|cycle| rows.row_mut(cycle)[0] = u32::from(cycle < 2));
    let verilator = build(&source).start(&Start::default()).unwrap().run(&rows).unwrap();
    let icarus = icarus::run(&source, &rows, None).unwrap();
    assert_eq!(icarus.first_difference(&source, &verilator), None);
    let sum = rows.iter().skip(2).take(400).fold(0, |sum, row| sum + row[1]) % 4096;
    assert_eq!(verilator.row(402)[0], sum);
}

#[test]
fn a_leaf_without_text_is_named() {
    let mut holder = Holder::default();
    holder.connect_all();
    let error = Source::emitted(&verilog::emit(&holder).unwrap(), |_| None).unwrap_err().to_string();
    assert_eq!(error, "design holder: there is no leaf stone: it must be rtl/stone.v");
}

#[test]
fn a_leaf_brings_the_leaves_that_it_stands_on() {
    let mut holder = Holder::default();
    holder.connect_all();
    let source = Source::emitted(&verilog::emit(&holder).unwrap(), |name| match name {
        "stone" => Some(STONE.into()),
        "pebble" => Some("module pebble;\nendmodule\n".into()),
        _ => None,
    });
    let files: Vec<String> = source.unwrap().files.into_iter().map(|(name, _)| name).collect();
    assert_eq!(files, ["pebble.v", "stone.v", "holder.v"]);
}
