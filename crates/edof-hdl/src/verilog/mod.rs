//! Verilog from rust-hdl circuits that means exactly what the Rust means.
//!
//! rust-hdl 0.46 gives every kernel as a syntax tree and every signal with its width, but its own printer loses the types:
//! literals become 32-bit numbers, parentheses and wrapping go missing. [`emit`] prints the same tree again, typed.
//!
//! | step | file | gives |
//! |---|---|---|
//! | collect | `collect` | the tree of blocks, their signals and kernels |
//! | name | `scope` | what every name in a kernel means |
//! | type | `typing` | [expressions](self) in which every operand has its width and sign |
//! | lower | `kernel` | typed statements, loops unrolled |
//! | check | `flow` | no latch, nothing read before it is written, nothing left open |
//! | split | `process` | plain assignments and `always @*` blocks |
//! | separate | `domains` | nothing from one clock domain to another but by a leaf of [`crossing`](crate::crossing) |
//! | order | `cycles` | no loop without a register, and no process that looks like one |
//! | connect | `wiring` | signals that need no wire of their own |
//! | print | `print`, `module` | the text of a module |
//!
//! What comes out is Verilog-2001, one module for each distinct block: ports end in `_i` and `_o`, a register `x` is `x_q`
//! fed by `x_d`, the wires of a part are `part_port`. Blocks say what they are by [`Circuit`], and what
//! rust-hdl has no word for is a [leaf](crate::leaf). Registers have no start-up value unless they are a `DFFWithInit`:
//! a kernel resets what it must. What cannot be translated exactly is refused with an [`EmitError`].
//!
//! ```
//! use edof_hdl::{describe::Circuit, verilog};
//! use rust_hdl::prelude::*;
//!
//! /// Counts enabled cycles; full in the last of 256.
//! #[derive(Circuit)]
//! struct Counter {
//!     pub clock: Signal<In, Clock>,
//!     pub enable: Signal<In, Bit>,
//!     pub full: Signal<Out, Bit>,
//!     count: DFF<Bits<8>>,
//! }
//!
//! impl Logic for Counter {
//!     #[hdl_gen]
//!     fn update(&mut self) {
//!         dff_setup!(self, clock, count);
//!         if self.enable.val() {
//!             self.count.d.next = self.count.q.val() + 1;
//!         }
//!         self.full.next = self.count.q.val() + 1 == 0;
//!     }
//! }
//!
//! let mut counter = Counter::default();
//! counter.connect_all();
//! let emitted = verilog::emit(&counter).unwrap();
//! assert_eq!(emitted.top, "counter");
//! assert!(emitted.modules[0].text.contains("assign full_o = (count_q + 8'd1) == 8'd0;"));
//! ```

mod collect;
mod cycles;
mod domains;
mod error;
mod expression;
mod flow;
mod kernel;
mod module;
mod names;
mod print;
mod process;
mod scope;
mod source;
mod types;
mod typing;
mod wiring;

use std::collections::{BTreeSet, HashMap};

pub use domains::Crossing;
pub use error::{EmitError, Fault};
pub use types::Type;

use crate::describe::Circuit;
use crate::leaf::Leaf;
use collect::Tree;
use module::Kind;
use names::{Names, snake_case};

/// A circuit as Verilog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Emitted {
    /// The modules, parts before what they are parts of.
    pub modules: Vec<Module>,
    /// Names of the hand-written leaves that the modules instantiate.
    pub leaves: BTreeSet<String>,
    /// Name of the top module.
    pub top: String,
    /// Ports of the top module.
    pub ports: Vec<Port>,
    /// Where something passes from one clock domain to another.
    pub crossings: Vec<Crossing>,
}

/// A module: the content of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Module {
    /// The module's name, and its file's without `.v`.
    pub name: String,
    /// The Verilog.
    pub text: String,
}

/// A port of a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// The field in Rust, for instance `stream.ready` or `lanes[3]`.
    pub field: String,
    /// The port in Verilog, for instance `stream_ready_o`.
    pub name: String,
    /// Into the module or out of it.
    pub direction: Direction,
    /// Width in bits.
    pub bits: usize,
    /// Two's complement.
    pub signed: bool,
    /// Declared as `Clock`.
    pub is_clock: bool,
}

/// Which way a port points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Into the module.
    Input,
    /// Out of the module.
    Output,
}

/// Prints a circuit on which `connect_all` was called.
///
/// # Errors
/// What cannot be translated exactly: see [`Fault`].
pub fn emit(top: &dyn Circuit) -> Result<Emitted, EmitError> {
    let tree = Tree::of(top);
    if tree.is_register() || tree.start_value().is_some() || Leaf::of(&tree.hdl).is_some() {
        return Err(EmitError::block(&tree.path, Fault::NotATop));
    }
    let crossings = domains::check(&tree)?;
    let mut emitter = Emitter::default();
    let top = emitter.block(&tree)?;
    Ok(Emitted {
        top: emitter.modules[top].name.clone(),
        ports: emitter.ports.swap_remove(top),
        modules: emitter.modules,
        leaves: emitter.leaves,
        crossings,
    })
}

#[derive(Default)]
struct Emitter {
    modules: Vec<Module>,
    ports: Vec<Vec<Port>>,
    /// Which ports of each module follow which within a cycle.
    paths: Vec<Vec<(usize, usize)>>,
    leaves: BTreeSet<String>,
    names: Names,
    /// Module of each content, by type name and text without the name.
    known: HashMap<(&'static str, String), usize>,
}

impl Emitter {
    /// The module of a block: one that is known, or a new one.
    fn block(&mut self, tree: &Tree) -> Result<usize, EmitError> {
        let fault = |fault| EmitError::block(&tree.path, fault);
        let description = tree.description.as_ref().ok_or_else(|| fault(Fault::Undescribed))?;
        let mut parts = vec![];
        for part in &tree.parts {
            let known = part.is_register() || part.start_value().is_some() || Leaf::of(&part.hdl).is_some();
            parts.push(if known { None } else { Some(self.block(part)?) });
        }
        let kinds: Vec<Option<Kind>> = (tree.parts.iter().zip(&parts))
            .map(|(part, module)| match module {
                Some(module) => Some(Kind::Module(
                    &self.modules[*module].name,
                    &self.ports[*module],
                    &self.paths[*module],
                )),
                None => Leaf::of(&part.hdl).map(Kind::Leaf),
            })
            .collect();
        let draft = module::draft(tree, description, &kinds)?;
        let leaves = tree.parts.iter().filter_map(|part| Leaf::of(&part.hdl));
        self.leaves.extend(leaves.map(|leaf| leaf.module));
        let key = (description.name, draft.text);
        if let Some(known) = self.known.get(&key) {
            return Ok(*known);
        }
        let name = self.names.take(&snake_case(description.name));
        let text = key.1.replace(module::NAME, &name);
        self.known.insert(key, self.modules.len());
        self.modules.push(Module { name, text });
        self.ports.push(draft.ports);
        self.paths.push(draft.paths);
        Ok(self.modules.len() - 1)
    }
}
