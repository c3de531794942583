//! The stranger's UART in three simulations, by the packaged kit.

use edof_verilog_diff::{Bench, Check, Simulator, check, harness};
use rust_hdl::prelude::Block;
use stranger::Loopback;

#[test]
fn the_uart_is_the_same_in_three_simulations() {
    let harness = harness!(Loopback, clock; reset, valid, data);
    let how = Check { reset: Some("reset"), cycles: 2_000, ..Check::default() };
    let agreement = check(&|| Loopback::new(6), &harness, &how).unwrap();
    assert_eq!((agreement.cycles, agreement.outputs), (1_996, 3));
}

#[test]
fn what_is_sent_is_received() {
    let mut uart = Loopback::new(6);
    uart.connect_all();
    let bench = Bench::new(&edof_verilog::emit(&uart).unwrap(), Simulator::Icarus).unwrap();
    // Inputs: reset, valid, data. Outputs: ready, came, received.
    let rows: Vec<Vec<u128>> = (0..80).map(|cycle| vec![u128::from(cycle < 2), u128::from(cycle == 5), 0xa7]).collect();
    let came: Vec<_> = bench.run(&rows).unwrap().into_iter().skip(2).filter(|row| row[1] == Some(1)).collect();
    assert_eq!(came.iter().map(|row| row[2]).collect::<Vec<_>>(), [Some(0xa7)]);
}

#[test]
fn blocks_name_the_strangers_lines() {
    let mut uart = Loopback::new(6);
    uart.connect_all();
    let emitted = edof_verilog::emit(&uart).unwrap();
    let sender = emitted.modules.iter().find(|module| module.name == "sender").unwrap();
    assert!(sender.text.contains("A bit lasts its cycles."), "{}", sender.text);
    assert!(sender.source.file.ends_with("src/lib.rs"));
}
