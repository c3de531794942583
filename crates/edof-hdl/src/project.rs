//! Everything that a generated design consists of, as text: modules, leaves, memory images.

use crate::blocks::chain::Chain;
use crate::describe::Circuit;
use crate::leaves;
use crate::verilog::{Crossing, EmitError, Port, SourceMap, emit};
use edof_device::board::Part;
use edof_device::design::memory::{self, Shifts};
use edof_device::design::{Design, DesignError};
use edof_network::{FixedNetwork, fixed_network::FixedNetworkError};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A generated design.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Project {
    /// Name of the top module.
    pub top: String,
    /// Ports of the top module.
    pub ports: Vec<Port>,
    /// File name and text of each module, parts before what they are parts of.
    pub verilog: Vec<(String, String)>,
    /// For each file that is not written by hand, the Rust lines behind its lines.
    pub sources: BTreeMap<String, SourceMap>,
    /// Path, relative to the design, and text of each memory image.
    pub memory: Vec<(String, String)>,
    /// Leaves between clock domains.
    pub crossings: Vec<Crossing>,
}

/// Why a design was not generated.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// The design, or a network that does not fit it.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// A network that cannot run exactly.
    #[error(transparent)]
    Network(#[from] FixedNetworkError),
    /// A circuit that has no exact Verilog.
    #[error(transparent)]
    Emit(#[from] EmitError),
}

impl Project {
    /// Returns the project with the leaves that a part has in its own cells in place of the portable ones.
    #[must_use]
    pub fn on_part(mut self, part: &Part) -> Self {
        for (name, text) in &mut self.verilog {
            let own = part.leaves.iter().find(|(leaf, _)| name.strip_suffix(".v") == Some(leaf));
            if let Some((_, own)) = own {
                *text = (*own).into();
            }
        }
        self
    }
}

/// The calculator chain of a design; its two sets start with these networks.
///
/// ```
/// use edof_device::Design;
/// use edof_network::weight_file;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let design = Design::from_json(include_str!("../../../designs/paper.json"))?;
/// let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
/// let network = weight_file::load_fixed(&root.join("weights/paper-t4.fixed.safetensors"))?;
/// let project = edof_hdl::project::calculator(&design, [&network, &network])?;
/// assert_eq!(project.top, "chain");
/// assert!(project.verilog.iter().map(|(_, text)| text.len()).sum::<usize>() < 400_000);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`ProjectError`]: what does not fit what.
pub fn calculator(design: &Design, sets: [&FixedNetwork; 2]) -> Result<Project, ProjectError> {
    sets.iter().try_for_each(|network| network.check())?;
    Ok(of_circuit(&mut Chain::checked(design, sets)?, images(design, sets))?)
}

/// Bytes of stack for the work on a whole core: its blocks are values of hundreds of kilobytes.
const STACK: usize = 64 << 20;

/// Does some work on a thread with a stack for whole cores; on this one where no thread can be had.
pub fn spacious<T: Send>(work: impl Fn() -> T + Sync) -> T {
    std::thread::scope(|scope| {
        match std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, &work) {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            Err(_) => work(),
        }
    })
}

/// A circuit with the leaves that it stands on and its memory images.
///
/// # Errors
/// The circuit has no exact Verilog.
pub fn of_circuit(circuit: &mut dyn Circuit, memory: Vec<(String, String)>) -> Result<Project, EmitError> {
    circuit.connect_all();
    let emitted = emit(circuit)?;
    let leaves = leaves::with_parts(&emitted.leaves)
        .into_iter()
        .map(|(name, text)| (format!("{name}.v"), text.into()));
    let file = |name: &str| format!("{name}.v");
    let sources = emitted.modules.iter().map(|module| (file(&module.name), module.source.clone())).collect();
    let modules = emitted.modules.into_iter().map(|module| (file(&module.name), module.text));
    let verilog = leaves.chain(modules).collect();
    let (top, ports, crossings) = (emitted.top, emitted.ports, emitted.crossings);
    Ok(Project { top, ports, verilog, sources, memory, crossings })
}

/// The memory images of all stages: set 0, then set 1, if the design has it.
#[must_use]
pub fn images(design: &Design, sets: [&FixedNetwork; 2]) -> Vec<(String, String)> {
    let mut images = Vec::new();
    for stage in design.stages() {
        for bank in 0..stage.banks() {
            for part in 0..stage.row_words() {
                let sets = sets.iter().take(stage.sets);
                let words = sets.flat_map(|network| memory::weight_words(network, &stage, bank, part));
                images.push((memory::weight_image(&stage, bank, part), hexadecimal(words, 16)));
            }
        }
        let kept = [(false, stage.shrinks()), (true, stage.sends_difference)];
        for (before, _) in kept.into_iter().filter(|(_, there)| *there) {
            let words = sets.iter().flat_map(|network| memory::threshold_words(network, &stage, before));
            images.push((memory::threshold_image(&stage, before), hexadecimal(words.map(u64::from), 8)));
        }
        let shifts = sets.iter().map(|network| u64::from(Shifts::of(network, &stage).word()));
        images.push((memory::shift_image(&stage), hexadecimal(shifts, 5)));
    }
    images
}

/// A `$readmemh` image: one word a line.
fn hexadecimal(words: impl Iterator<Item = u64>, digits: usize) -> String {
    words.fold(String::new(), |mut text, word| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{word:0digits$x}");
        text
    })
}
