//! Verilog from rust-hdl circuits that means exactly what the Rust means.
//!
//! rust-hdl 0.46 gives every kernel as a syntax tree and every signal with its width, but its own printer loses the types:
//! literals become 32-bit numbers, parentheses and wrapping go missing. [`emit`] prints the same tree again, typed.
//!
//! | step | file | gives |
//! |---|---|---|
//! | collect | `collect` | the tree of blocks, their signals and kernels |
//! | leaves | `leaf_text`, `leaf_check` | declarations of leaves, compared with those of their blocks |
//! | name | `scope` | what every name in a kernel means |
//! | type | `typing` | [expressions](self) in which every operand has its width and sign |
//! | lower | `kernel` | typed statements, loops unrolled |
//! | check | `flow` | no latch, nothing read before it is written, nothing left open |
//! | tidy | `tidy`, `cases` | comparisons and chains of `if` in the form that people write |
//! | split | `edge`, `settle`, `process`, `cycles` | what registers take at the clock's edge, and a process for each other target; no loop without a register |
//! | separate | `domains` | nothing from one clock domain to another but by a leaf that is declared a crossing |
//! | shorten | `simplify`, `flags`, `live` | one assignment where it says all; nothing that leads nowhere |
//! | join | `blocks` | one `always @*` for a block of the kernel, where that looks like no loop |
//! | connect | `wiring`, `arrays` | signals that need no wire of their own; loops over equal parts |
//! | write | `draft`, `write`, `header`, `constants`, `instances`, `statements`, `print`, `text` | a sheet: all of a module but what it is given |
//! | share | `parameters`, `interface`, `formula` | which values are parameters, because they differ from place to place, and which follow from others |
//! | put together | `sheet`, `layout` | the text of a module, no line too long |
//!
//! What comes out is Verilog-2001, one module for each distinct block, with parameters where two differ in a
//! constant alone: ports end in `_i` and `_o`, a register `x` is `x_q`,
//! fed by `x_d` where the kernel reads its next value, the wires of a part are `part_port`. Blocks say what they are by [`Circuit`], and what
//! rust-hdl has no word for is a [leaf]. Registers have no start-up value unless they are a `DFFWithInit`:
//! a kernel resets what it must. What cannot be translated exactly is rejected with an [`EmitError`].
//!
//! `README.md` has a first circuit, leaves, and what to do about each rejection.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

mod arrays;
mod blocks;
mod cases;
// So that `#[derive(Circuit)]` can name this crate from within, too.
extern crate self as edof_verilog;

pub mod describe;
pub mod formula;
pub mod leaf;

mod collect;
mod constants;
mod cycles;
mod domains;
mod draft;
mod edge;
mod error;
mod expression;
mod flags;
mod flow;
mod header;
mod instances;
mod interface;
mod kernel;
mod kind;
mod layout;
mod leaf_check;
mod leaf_text;
mod live;
mod names;
mod optional;
mod order;
mod parameters;
mod print;
mod process;
mod quiet;
mod scope;
mod settle;
mod sheet;
mod simplify;
mod single;
mod source;
mod statements;
mod text;
mod tidy;
mod types;
mod typing;
mod unread;
mod value;
mod wiring;
mod write;

use std::collections::{BTreeMap, BTreeSet, HashMap};

pub use domains::Crossing;
pub use error::{EmitError, Fault, rust_path};
pub use optional::Optional;
pub use types::Type;

/// The page's circuits run.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;

use crate::describe::Circuit;
use crate::leaf::Leaf;
use collect::Tree;
use draft::Style;
use kind::{Kind, Occurrence};
use leaf_text::LeafText;
use names::Names;
use sheet::Sheet;

/// A circuit as Verilog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Emitted {
    /// The modules, parts before what they are parts of.
    pub modules: Vec<Module>,
    /// Names of the hand-written leaves that the modules instantiate.
    pub leaves: BTreeSet<String>,
    /// Texts of the leaves, by name, each with the modules that it instantiates.
    pub leaf_texts: BTreeMap<String, String>,
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
    /// The Rust that it comes from.
    pub source: SourceMap,
}

/// Which line of Rust a line of a module comes from; known of kernels with [`macro@describe::kernel`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SourceMap {
    /// Rust file of the module's block.
    pub file: String,
    /// For each line of the text, from the first on, the number of the Rust line; none for declarations and instances.
    pub lines: Vec<Option<usize>>,
}

impl SourceMap {
    /// Runs of lines that come from one Rust line: first and last line of Verilog, and the line of Rust, all counted from 1.
    #[must_use]
    pub fn runs(&self) -> Vec<(usize, usize, usize)> {
        let mut runs: Vec<(usize, usize, usize)> = vec![];
        for (line, rust) in self.lines.iter().enumerate().filter_map(|(n, rust)| Some((n + 1, (*rust)?))) {
            match runs.last_mut() {
                Some((_, last, of)) if *last + 1 == line && *of == rust => *last = line,
                _ => runs.push((line, line, rust)),
            }
        }
        runs
    }
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
    emit_as(top, Style::Readable)
}

/// Prints a circuit without making its text shorter: expressions stand as they do in Rust, each target has a process of its own. The modules,
/// their ports and registers are those of [`emit`], which can be proven to mean the same.
///
/// # Errors
/// Those of [`emit`].
pub fn emit_literally(top: &dyn Circuit) -> Result<Emitted, EmitError> {
    emit_as(top, Style::Literal)
}

fn emit_as(top: &dyn Circuit, style: Style) -> Result<Emitted, EmitError> {
    let tree = Tree::of(top);
    if tree.is_register() || tree.start_value().is_some() || Leaf::of(&tree.hdl).is_some() {
        return Err(EmitError::block(&tree.path, Fault::NotATop));
    }
    let mut emitter = Emitter { style, ..Emitter::default() };
    emitter.leaves(&tree)?;
    let crossings = domains::check(&tree)?;
    let top = emitter.block(&tree, true)?;
    Ok(emitter.emitted(&top, crossings))
}

#[derive(Default)]
struct Emitter {
    style: Style,
    sheets: Vec<Sheet>,
    /// The names that are taken inside each module.
    inside: Vec<Names>,
    ports: Vec<Vec<Port>>,
    /// Which ports of each module follow which within a cycle.
    paths: Vec<Vec<(usize, usize)>>,
    texts: BTreeMap<String, LeafText>,
    leaves: BTreeSet<String>,
    leaf_texts: BTreeMap<String, String>,
    names: Names,
    /// Module of each sheet.
    known: HashMap<Sheet, usize>,
}

impl Emitter {
    /// Reads the leaves of a tree and holds each to its block; their names are theirs alone.
    fn leaves(&mut self, tree: &Tree) -> Result<(), EmitError> {
        for part in &tree.parts {
            let Some(leaf) = Leaf::of(&part.hdl) else {
                self.leaves(part)?;
                continue;
            };
            let fault = |fault| EmitError::block(&part.path, fault);
            if !self.texts.contains_key(&leaf.source) {
                let text = LeafText::read(&leaf.source).map_err(|why| fault(Fault::LeafText(why)))?;
                std::iter::once(&text.module).chain(&text.parts).for_each(|name| self.names.reserve(name));
                self.texts.insert(leaf.source.clone(), text);
            }
            leaf_check::check(part, &leaf, &self.texts[&leaf.source]).map_err(fault)?;
            self.leaves.insert(leaf.module.clone());
            self.leaf_texts.insert(leaf.module, leaf.source);
        }
        Ok(())
    }

    /// The module of a block, one that is known or a new one, and the values that it has there.
    fn block(&mut self, tree: &Tree, is_top: bool) -> Result<Occurrence, EmitError> {
        let fault = |fault| EmitError::block(&tree.path, fault);
        let description = tree.description.as_ref().ok_or_else(|| fault(Fault::Undescribed))?;
        let mut parts = vec![];
        for part in &tree.parts {
            let known = part.is_register() || part.start_value().is_some() || Leaf::of(&part.hdl).is_some();
            parts.push(if known { None } else { Some(self.block(part, false)?) });
        }
        let kinds: Vec<Option<Kind>> = (tree.parts.iter().zip(&parts))
            .map(|(part, occurrence)| match occurrence {
                Some(occurrence) => {
                    let (ports, paths) = (&self.ports[occurrence.class], &self.paths[occurrence.class]);
                    Some(Kind::Module { occurrence, ports, paths })
                }
                None => Leaf::of(&part.hdl).map(|leaf| {
                    let paths = self.texts.get(&leaf.source).map_or(vec![], |text| text.paths.clone());
                    Kind::Leaf(leaf, paths)
                }),
            })
            .collect();
        let draft = draft::draft(tree, description, &kinds, is_top, self.style)?;
        drop(kinds);
        let class = match self.known.get(&draft.sheet) {
            Some(known) => *known,
            None => {
                self.known.insert(draft.sheet.clone(), self.sheets.len());
                self.sheets.push(draft.sheet);
                self.inside.push(draft.names);
                self.ports.push(draft.ports);
                self.paths.push(draft.paths);
                self.sheets.len() - 1
            }
        };
        let parts = draft.instances.iter().map(|part| parts[*part].clone()).collect();
        Ok(Occurrence { class, values: draft.values, parts })
    }

    fn emitted(mut self, top: &Occurrence, crossings: Vec<Crossing>) -> Emitted {
        let interfaces = parameters::settle(&self.sheets, &mut self.inside, top);
        let names: Vec<String> = self.sheets.iter().map(|sheet| self.names.take(&sheet.name)).collect();
        let modules = self.sheets.iter().zip(&interfaces).zip(&names).map(|((sheet, interface), name)| {
            let (text, lines) = sheet.text(name, interface, &|class| names[class].clone());
            let source = SourceMap { file: sheet.source.clone(), lines };
            Module { name: name.clone(), text, source }
        });
        Emitted {
            modules: modules.collect(),
            leaves: self.leaves,
            leaf_texts: self.leaf_texts,
            top: names[top.class].clone(),
            ports: self.ports.swap_remove(top.class),
            crossings,
        }
    }
}
