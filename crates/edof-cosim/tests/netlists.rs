//! What Yosys maps, simulated with models of an FPGA's cells: the same words in the same cycles as the text that it was mapped from. So what a
//! tool makes of the text is tried as well, and the initial contents of its block RAMs.

use crate::agents;
use crate::common::{Setup, committed, expect_clean, moderate, patches};
use crate::support;
use edof_core::draw::Draw;
use edof_cosim::chain::Drive;
use edof_cosim::verilator::{Library, Start};
use edof_cosim::yosys::{self, ecp5};
use edof_cosim::{Port, Source};
use edof_golden::cycle::Stalls;

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_netlist_of_tinys_chain_gives_the_models_words_in_the_models_cycles() {
    let design = committed("tiny");
    let networks = [5, 6].map(|seed| moderate(&design, seed));
    agrees(&Setup::mapped(design, networks, yosys::mapped));
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_netlist_of_the_open_boards_chain_gives_the_models_words_in_the_models_cycles() {
    let design = committed("ulx3s");
    let networks = [5, 5].map(|seed| moderate(&design, seed));
    let map = |source: &Source, options: &yosys::Options| ecp5::mapped(source, options, &ecp5::SYNTHESIS);
    agrees(&Setup::mapped(design, networks, map));
}

/// Runs patches through a netlist and its model, with stalls and without.
fn agrees(setup: &Setup) {
    for (seed, stalled) in [(1, 0), (2, 90)] {
        let drive = Drive { stalls: Some(Stalls::drawn(seed, stalled)), ..Drive::default() };
        let outcome = setup.run(&drive, patches(&setup.design, 12, seed), seed);
        expect_clean(&outcome);
        println!("{} beats in {} cycles", outcome.beats, outcome.cycles);
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn frames_come_out_whole_and_in_order_of_the_netlist_of_the_agents() {
    let source = yosys::mapped(&agents::plain(), &yosys::Options::default()).unwrap();
    agents::whole_frames_come_out_in_order(&source, 0..2);
}

/// A memory as `ram_style` asks for block RAM, of one width and depth, and what is read from it where a write goes to the same row or not.
fn memory(width: usize, depth: usize) -> Source {
    let bits = depth.ilog2();
    let text = format!(
        "module memory (\n    input wire clock_i,\n    input wire write_i,\n    input wire [{0}:0] row_i,\n    \
         input wire [{0}:0] write_row_i,\n    input wire [{1}:0] data_i,\n    output reg [{1}:0] data_o\n);\n    \
         (* ram_style = \"block\" *) reg [{1}:0] rows [0:{2}];\n    integer row;\n    \
         initial for (row = 0; row < {3}; row = row + 1) rows[row] = {{3{{row * 32'd2654435761}}}};\n    \
         always @(posedge clock_i) begin\n        if (write_i) rows[write_row_i] <= data_i;\n        \
         data_o <= rows[row_i];\n    end\nendmodule\n",
        bits - 1,
        width - 1,
        depth - 1,
        depth
    );
    let ports = vec![
        Port::clock("clock_i"),
        Port::input("write_i", 1),
        Port::input("row_i", bits as usize),
        Port::input("write_row_i", bits as usize),
        Port::input("data_i", width),
        Port::output("data_o", width),
    ];
    Source { top: "memory".into(), files: vec![("memory.v".into(), text)], ports }
}

/// Bits of a word that Yosys 0.23 writes wrongly: it connects the lower half's parity bits to the upper half of a memory of more than 36 bits
/// (`DIPBDIP` in its `xilinx/brams_xc6v_map.v`).
const WRITTEN_WRONGLY: u64 = 1 << 44 | 1 << 53 | 1 << 62;

/// What is read in each of some thousand cycles, without the bits that Yosys writes wrongly.
fn read(source: &Source, width: usize, depth: usize) -> Vec<u64> {
    let known = if width > 36 { !WRITTEN_WRONGLY } else { u64::MAX };
    let library = Library::build(source, &support::options()).unwrap();
    let mut model = library.start(&Start::default()).unwrap();
    let draw = &mut Draw::new(width as u64);
    let mut found = vec![];
    for cycle in 0..4_000 {
        // All rows at first, then few, so that a row is often written while it is read.
        let max = if cycle < 2_000 { depth } else { 4 } as i64 - 1;
        let inputs = [draw.whole(0, 1) as u64, draw.whole(0, max) as u64, draw.whole(0, max) as u64];
        for (port, value) in (1..).zip(inputs) {
            model.poke(port, value).unwrap();
        }
        model.poke(4, draw.bits() >> (64 - width)).unwrap();
        model.tick().unwrap();
        found.push(model.peek(5).unwrap() & known);
    }
    found
}

#[test]
#[ignore = "a minute: scripts/soak.sh"]
fn block_rams_read_what_the_text_reads_in_every_width() {
    for (width, depth) in
        [(1, 16384), (2, 8192), (4, 4096), (9, 2048), (16, 1024), (36, 512), (36, 1024), (64, 512)]
    {
        let source = memory(width, depth);
        let mapped = yosys::mapped(&source, &yosys::Options::default()).unwrap();
        assert!(mapped.files[0].1.contains("RAMB"), "{width} x {depth} is no block RAM");
        assert_eq!(read(&mapped, width, depth), read(&source, width, depth), "{width} x {depth}");
    }
}
