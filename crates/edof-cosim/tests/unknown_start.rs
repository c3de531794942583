//! What stands between the board and its users, begun with unknown registers in Icarus: after a reset everything that controls is known, and what
//! is known is what Verilator has, which began with random registers.

use crate::agents;
use crate::common::committed;
use crate::support;
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Layout, Rows, Source, icarus};
use edof_hdl::board::i2c_master::I2cMaster;
use edof_hdl::board::{BoardRegisters, Identity, UartBus};

/// Cycles of reset at the start.
const RESET: usize = 48;

/// Random inputs, each row held for `hold` cycles, after a reset; 0 on the inputs of names that end in one of `quiet`.
fn stimulus(source: &Source, cycles: usize, hold: usize, quiet: &[&str]) -> Rows {
    let layout = Layout::inputs(source);
    let random = layout.random(cycles.div_ceil(hold), 7);
    let mut rows = Rows::new(layout.words());
    for cycle in 0..cycles {
        let row = rows.push_zeros();
        row.copy_from_slice(random.row(cycle / hold));
        let mut put = |name: &str, value| layout.put(row, source.port(name).unwrap(), value).unwrap();
        put("reset_i", u64::from(cycle < RESET));
        quiet.iter().for_each(|name| put(name, 0));
    }
    rows
}

/// Runs a source in both simulators; `words` are ends of outputs that may be unknown, because nobody reads them as long as nothing is offered.
fn known_after_reset(source: &Source, hold: usize, quiet: &[&str], words: &[&str]) {
    let stimulus = stimulus(source, 12_000, hold, quiet);
    let verilator = Library::build(source, &support::options()).unwrap();
    let verilator = verilator.start(&Start { seed: 5, ..Start::default() }).unwrap().run(&stimulus).unwrap();
    let mut icarus = icarus::run(source, &stimulus, None).unwrap();
    // Before the first edge an `if` of an unknown register is false here, and true or false there.
    icarus.unknown.row_mut(0).fill(u32::MAX);
    assert_eq!(icarus.first_difference(source, &verilator), None);
    let layout = Layout::outputs(source);
    for slot in layout.slots() {
        let port = &source.ports[slot.port].name;
        if words.iter().any(|end| port.ends_with(end)) {
            continue;
        }
        let unknown = |cycle: &usize| layout.get(icarus.unknown.row(*cycle), slot.port).unwrap() != 0;
        assert_eq!(
            (RESET..stimulus.len()).find(unknown),
            None,
            "{}.{port} is unknown in a cycle",
            source.top
        );
    }
}

#[test]
fn the_serial_line_knows_what_it_does_after_a_reset() {
    let source = Source::circuit(&mut UartBus::new(16, 500)).unwrap();
    known_after_reset(&source, 16, &[], &["data_o", "addr_o"]);
    known_after_reset(&source, 3, &[], &["data_o", "addr_o"]);
}

#[test]
fn the_i2c_master_knows_what_it_does_after_a_reset() {
    let source = Source::circuit(&mut I2cMaster::new(4)).unwrap();
    known_after_reset(&source, 9, &[], &["value_o"]);
}

#[test]
fn the_registers_know_what_they_hold_after_a_reset() {
    let identity = Identity { design_hash: 1, weights_hash: 2, frame: (64, 48) };
    let source = Source::circuit(&mut BoardRegisters::new(&committed("tiny"), &identity)).unwrap();
    known_after_reset(&source, 1, &["preserve_i"], &["data_o", "address_o"]);
}

#[test]
fn the_agents_know_what_they_do_after_a_reset() {
    known_after_reset(&agents::plain(), 1, &[], &["data_o", "addr_o", "len_o", "last_o"]);
}
