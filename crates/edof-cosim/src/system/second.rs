//! The same frames through Icarus, which shares no code with Verilator and knows four states: the bench of Verilog that a generated
//! directory tries itself with.

use crate::chain::verilated::write_images;
use crate::error::at;
use crate::{Error, Source, tool, work};
use edof_hdl::benches::{self, RecordedVideo};
use edof_hdl::project::Project;
use std::fs;

/// Runs a core's bench in Icarus; gives what it says at its end.
///
/// # Errors
/// A tool is missing, or the screen shows something else: [`Error::ToolFailed`] with the bench's words.
pub fn icarus(core: &Project, recorded: &RecordedVideo) -> Result<String, Error> {
    let work = work::folder()?;
    let source = Source::from(core);
    source.write(work.path())?;
    write_images(core, work.path())?;
    for (name, text) in benches::core_bench(core, recorded) {
        let path = work.path().join(name);
        path.parent().map_or(Ok(()), fs::create_dir_all).map_err(at(&path))?;
        fs::write(&path, text).map_err(at(&path))?;
    }
    let mut compile = tool::command("iverilog", work.path());
    compile.args(["-g2012", "-s", "edof_core_bench", "-o", "bench.vvp", "sim/core_bench.sv"]);
    tool::run(compile.args(source.file_names().filter(|name| name.ends_with(".v"))))?;
    let said = tool::run(tool::command("vvp", work.path()).args(["-n", "bench.vvp"]))?;
    let passed = said.lines().find(|line| line.starts_with("PASS")).map(str::to_owned);
    passed.ok_or_else(|| Error::Stopped(format!("Icarus: {}", said.lines().last().unwrap_or("nothing"))))
}
