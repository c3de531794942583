//! A run once more in Icarus: the same inputs must give the same outputs.

use super::device::{Device, Inputs, Outputs, join};
use crate::error::{Error, at};
use crate::icarus::{self, Difference};
use crate::rows::{Layout, Rows};
use crate::{Source, chain::verilated};
use edof_hdl::project::Project;
use edof_spec::design::memory::Set;

/// A device that keeps what it was given.
pub struct Recorded<D> {
    device: D,
    inputs: Vec<Inputs>,
}

impl<D: Device> Recorded<D> {
    /// Records from now on.
    pub const fn new(device: D) -> Self {
        Self { device, inputs: Vec::new() }
    }

    /// What it was given in every cycle.
    #[must_use]
    pub fn inputs(&self) -> &[Inputs] {
        &self.inputs
    }
}

impl<D: Device> Device for Recorded<D> {
    fn cycle(&mut self, inputs: &Inputs, outputs: &mut Outputs) -> Result<(), Error> {
        self.inputs.push(*inputs);
        self.device.cycle(inputs, outputs)
    }
}

/// Runs recorded inputs in Verilator and in Icarus; gives the first output that differs among those that Icarus knows.
///
/// # Errors
/// A tool is missing or refuses the text, or the simulation stops.
pub fn icarus(
    project: &Project,
    compiled: &verilated::Compiled,
    inputs: &[Inputs],
    seed: u64,
) -> Result<Option<Difference>, Error> {
    let source = Source::from(project);
    let stimulus = rows(&source, inputs)?;
    let expected = compiled.start(seed)?.model().run(&stimulus)?;
    let images = tempfile::tempdir().map_err(at(&std::env::temp_dir()))?;
    verilated::write_images(project, images.path())?;
    let observed = icarus::run(&with_cleared_memories(source.clone()), &stimulus, Some(images.path()))?;
    let lead = inputs.iter().take_while(|inputs| inputs.reset).count();
    if observed.known_from() > lead {
        let problem = format!("outputs are unknown until cycle {}", observed.known_from());
        return Err(Error::Output { tool: "iverilog".into(), problem });
    }
    Ok(observed.first_difference(&source, &expected))
}

/// The chain for Icarus, its memories without an image full of zeros. An idle multiplier multiplies 0 by whatever weight the
/// memories' leftovers point to: 0 in any circuit, but unknown to a simulator that starts with unknown memories.
#[must_use]
pub fn with_cleared_memories(mut source: Source) -> Source {
    for (leaf, memory, rows) in
        [("edof_ram.v", "words [0:DEPTH-1];", "DEPTH"), ("edof_fifo.v", "memory [0:15];", "16")]
    {
        let name = memory.split(' ').next().unwrap_or_default();
        let unknown = format!("{name}[row] === {{WIDTH{{1'bx}}}}");
        let clear = format!("for (row = 0; row < {rows}; row = row + 1) if ({unknown}) {name}[row] = 0;");
        for (_, text) in source.files.iter_mut().filter(|(file, _)| file == leaf) {
            *text = text.replace(memory, &format!("{memory}\n integer row;\n initial {clear}"));
        }
    }
    source
}

/// Inputs as rows of a chain's ports.
///
/// # Errors
/// The source has not the ports of a chain.
pub fn rows(source: &Source, inputs: &[Inputs]) -> Result<Rows, Error> {
    let layout = Layout::inputs(source);
    let mut rows = Rows::new(layout.words());
    for input in inputs {
        let beat = input.window;
        let (address, data) = input.write.unwrap_or_default();
        let values = [
            ("reset_i", u64::from(input.reset)),
            ("window_valid_i", u64::from(beat.is_some())),
            ("window_data_i", beat.map_or(0, |beat| join(beat.words).into())),
            ("window_last_i", beat.map_or(0, |beat| beat.last.into())),
            ("window_set_i", beat.map_or(0, |beat| u64::from(beat.set == Set::Second))),
            ("patch_ready_i", u64::from(input.patch_ready)),
            ("write_valid_i", u64::from(input.write.is_some())),
            ("write_address_i", address.into()),
            ("write_data_i", data.into()),
            ("status_address_i", input.status_address.into()),
        ];
        let row = rows.push_zeros();
        for (port, value) in values {
            layout.put(row, source.port(port)?, value)?;
        }
    }
    Ok(rows)
}
