//! A run once more in Icarus: the same inputs must give the same outputs.

use super::device::{Device, Inputs, Outputs, join};
use crate::error::Error;
use crate::icarus::{self, Difference, Observed};
use crate::rows::{Layout, Rows};
use crate::{Source, chain::verilated, work};
use edof_device::design::memory::Set;
use edof_hdl::project::Project;

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

    /// The device.
    pub const fn device(&mut self) -> &mut D {
        &mut self.device
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
/// A tool is missing or rejects the text, or the simulation stops.
pub fn icarus(
    project: &Project,
    compiled: &verilated::Compiled,
    inputs: &[Inputs],
    seed: u64,
) -> Result<Option<Difference>, Error> {
    let source = Source::from(project);
    let stimulus = rows(&source, inputs)?;
    let expected = compiled.start(seed)?.model().run(&stimulus)?;
    let images = work::folder()?;
    verilated::write_images(project, images.path())?;
    let observed = icarus::run(&with_random_memories(source.clone()), &stimulus, Some(images.path()))?;
    let lead = inputs.iter().take_while(|inputs| inputs.reset).count();
    if let Some(port) = unknown(&source, &observed, &expected, lead)? {
        let problem = format!("{port} is unknown to it after reset");
        return Err(Error::Output { tool: "iverilog".into(), problem });
    }
    Ok(observed.first_difference(&source, &expected))
}

/// An output that Icarus must know and does not: what says whether a beat passes, from reset on, and the beats that pass.
fn unknown(
    source: &Source,
    icarus: &Observed,
    expected: &Rows,
    lead: usize,
) -> Result<Option<String>, Error> {
    let layout = Layout::outputs(source);
    for port in source.ports.iter().map(|port| port.name.as_str()) {
        let valid = if port.starts_with("between_") {
            port.replace("_data_", "_valid_").replace("_last_", "_valid_").replace("_set_", "_valid_")
        } else {
            port.replace("_data_o", "_valid_o").replace("_last_o", "_valid_o").replace("_set_o", "_valid_o")
        };
        let is_control = port.starts_with("between_valid_")
            || port.starts_with("between_ready_")
            || port == "patch_valid_o"
            || port == "window_ready_o";
        if port.ends_with("_i") || (valid == port && !is_control) {
            continue;
        }
        let (value, valid) = (source.port(port)?, source.port(&valid)?);
        for cycle in lead..expected.len() {
            let counts = is_control || layout.get(expected.row(cycle), valid)? == 1;
            if counts && layout.get(icarus.unknown.row(cycle), value)? != 0 {
                return Ok(Some(port.into()));
            }
        }
    }
    Ok(None)
}

/// The design for Icarus, its memories without an image full of random words, as Verilator's are. An idle multiplier multiplies 0 by
/// whatever weight the memories' leftovers point to: 0 in any circuit, but unknown to a simulator whose memories are unknown.
#[must_use]
pub fn with_random_memories(mut source: Source) -> Source {
    let memory = "words [0:DEPTH-1];";
    let fill = "\n integer row, place;\n initial for (row = 0; row < DEPTH; row = row + 1) if (words[row] === {WIDTH{1'bx}})\n \
                for (place = 0; place < WIDTH; place = place + 1) words[row][place] = $random;\n";
    for (_, text) in source.files.iter_mut().filter(|(file, _)| file == "edof_ram.v") {
        *text = text.replace(memory, &format!("{memory}{fill}"));
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
            ("flush_i", u64::from(input.flush)),
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
