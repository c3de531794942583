//! The same frames through Icarus, which shares no code with Verilator and knows four states: the bench of Verilog that a generated
//! directory tries itself with, and a host beside it.

use crate::chain::verilated::write_images;
use crate::error::at;
use crate::{Error, Source, mutant, tool, work};
use edof_hdl::benches::{self, RecordedVideo};
use edof_hdl::project::Project;
use std::fmt::Write;
use std::fs;

/// A host that carries out steps at the core of the bench.
const HOST: &str = include_str!("../../../../sim/icarus/check_bench.sv");

/// What a host does; addresses are of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Writes a word.
    Write(u32, u32),
    /// Reads, and expects this word.
    Expect(u32, u32),
    /// Waits for N cycles of the core.
    Wait(u32),
    /// Reads until this word comes.
    Until(u32, u32),
    /// Reads until it is another word than at the last step of this kind.
    Changed(u32),
}

impl Step {
    /// As the bench reads it.
    fn line(self) -> String {
        let (what, address, word) = match self {
            Self::Write(address, word) => (0, address, word),
            Self::Expect(address, word) => (1, address, word),
            Self::Wait(cycles) => (2, 0, cycles),
            Self::Until(address, word) => (3, address, word),
            Self::Changed(address) => (4, address, 0),
        };
        format!("{what:08x}{address:08x}{:08x}{word:08x}\n", u32::MAX)
    }
}

/// Runs a core's bench in Icarus; gives what it says at its end.
///
/// # Errors
/// A tool is missing, or the screen shows something else: [`Error::ToolFailed`] with the bench's words.
pub fn icarus(core: &Project, recorded: &RecordedVideo) -> Result<String, Error> {
    run(core, recorded, "edof_core_bench", &[])
}

/// The same core and camera in Icarus with a host; gives what the bench says at its end. The frames must be as many as are sent until the
/// last step.
///
/// # Errors
/// As [`icarus`]; the step and the register that is not as expected.
pub fn host_in_icarus(core: &Project, recorded: &RecordedVideo, steps: &[Step]) -> Result<String, Error> {
    let mut text = String::new();
    for step in steps {
        // Writing to a String cannot fail.
        let _ = write!(text, "{}", step.line());
    }
    let bench = HOST.replace("@steps@", &steps.len().to_string());
    let files = [("sim/check_bench.sv".to_owned(), bench), ("sim/steps.hex".to_owned(), text)];
    run(core, recorded, "edof_check_bench", &files)
}

fn run(
    core: &Project,
    recorded: &RecordedVideo,
    top: &str,
    more: &[(String, String)],
) -> Result<String, Error> {
    let work = work::folder()?;
    let source = Source::from(core);
    mutant::simulated(&source)?.write(work.path())?;
    write_images(core, work.path())?;
    for (name, text) in benches::core_bench(core, recorded).iter().chain(more) {
        let path = work.path().join(name);
        path.parent().map_or(Ok(()), fs::create_dir_all).map_err(at(&path))?;
        fs::write(&path, text).map_err(at(&path))?;
    }
    let benches = more.iter().map(|(name, _)| name.as_str()).filter(|name| name.ends_with(".sv"));
    let mut compile = tool::command("iverilog", work.path());
    compile.args(["-g2012", "-s", top, "-o", "bench.vvp", "sim/core_bench.sv"]).args(benches);
    tool::run(compile.args(source.file_names().filter(|name| name.ends_with(".v"))))?;
    let said = tool::run(tool::command("vvp", work.path()).args(["-n", "bench.vvp"]))?;
    let passed = said.lines().find(|line| line.starts_with("PASS")).map(str::to_owned);
    passed.ok_or_else(|| Error::Stopped(format!("Icarus: {}", said.lines().last().unwrap_or("nothing"))))
}
