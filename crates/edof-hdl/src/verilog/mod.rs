//! Verilog from rust-hdl circuits.
