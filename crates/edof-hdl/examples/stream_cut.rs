//! Prints the Verilog of a block that stands alone: `cargo run -p edof-hdl --example stream_cut`. `scripts/prove.sh` proves it.

use edof_hdl::ports::StreamCut;
use edof_verilog::EmitError;
use rust_hdl::prelude::*;

fn main() -> Result<(), EmitError> {
    let mut cut = StreamCut::<2>::default();
    cut.connect_all();
    print!("{}", edof_verilog::emit(&cut)?.modules[0].text);
    Ok(())
}
