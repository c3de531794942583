//! The generated Verilog, run by Verilator and Icarus, and held to the golden model bit for bit and cycle for cycle.
