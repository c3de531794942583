//! What the backend must know of a block and its syntax tree does not say: name, source, header, comments.
//!
//! rust-hdl has no room for these, so they come by a walk of their own: [`Circuit`], which a block derives.
//!
//! ```
//! use edof_verilog::describe::Circuit;
//! use rust_hdl::prelude::*;
//!
//! /// Whether x is a number that was chosen when the circuit was made.
//! #[derive(Circuit)]
//! struct Equals {
//!     /// What comes in.
//!     pub x: Signal<In, Bits<8>>,
//!     /// Whether it is the number.
//!     pub found: Signal<Out, Bit>,
//!     number: Constant<Bits<8>>,
//! }
//!
//! impl Equals {
//!     fn to(number: u64) -> Self {
//!         Self::from_parts(EqualsParts { number: Constant::new(number.into()) })
//!     }
//! }
//!
//! impl Logic for Equals {
//!     #[hdl_gen]
//!     fn update(&mut self) {
//!         self.found.next = self.x.val() == self.number.val();
//!     }
//! }
//!
//! let mut seven = Equals::to(7);
//! seven.connect_all();
//! let text = &edof_verilog::emit(&seven).unwrap().modules[0].text;
//! assert!(text.starts_with("// Whether x is a number that was chosen when the circuit was made.\n"));
//! ```

use rust_hdl::prelude::{Block, Constant, DFF, DFFWithInit, Direction, Signal, Synth, Verilog};
use std::collections::HashMap;
use std::ops::BitXor;

pub use edof_verilog_derive::{Circuit, kernel};

/// Name, source file, header and comments of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Description {
    /// The Rust type's own name, without path and parameters, for instance `PairBuffer`.
    pub name: &'static str,
    /// Rust file.
    pub source: &'static str,
    /// What a user of the block must know: the type's documentation.
    pub header: &'static str,
    /// Suffix that distinguishes blocks of one type, in the names of their modules; may be empty.
    pub role: String,
    /// Fields that have documentation, and it, in one line each.
    pub fields: &'static [(&'static str, &'static str)],
    /// Arrays whose elements have names, and these.
    pub names: Vec<(&'static str, Vec<String>)>,
    /// Constants that are printed as their values.
    pub literals: &'static [&'static str],
    /// Constants of unsigned type that are two's complement.
    pub signed: &'static [&'static str],
    /// What constants, and parameters of leaves, follow from.
    pub formulas: Vec<Formula>,
}

/// What a constant, or a parameter of a leaf, follows from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Formula {
    /// The constant, or the part that is a leaf.
    pub field: &'static str,
    /// The leaf's parameter; empty for a constant.
    pub parameter: &'static str,
    /// The formula in Verilog, each constant that it names in braces.
    pub text: &'static str,
    /// The constants that it names.
    pub names: &'static [&'static str],
    /// Its value.
    pub value: u64,
}

impl Formula {
    /// The formula with the constants as the block calls them.
    #[must_use]
    pub fn plain(&self) -> String {
        self.text.replace(['{', '}'], "")
    }
}

impl Description {
    /// What a constant follows from, or a parameter of a leaf.
    #[must_use]
    pub fn formula(&self, field: &str, parameter: &str) -> Option<&Formula> {
        self.formulas.iter().find(|formula| formula.field == field && formula.parameter == parameter)
    }

    /// What is said of a field.
    #[must_use]
    pub fn of(&self, field: &str) -> Option<&'static str> {
        self.fields.iter().find(|(name, _)| *name == field).map(|(_, comment)| *comment)
    }

    /// The name of an array's element, for the key `at$8` for instance `status`, and what follows in the key.
    pub(crate) fn element<'d>(&'d self, key: &'d str) -> Option<(&'d str, &'d str, &'d str)> {
        let (field, rest) = key.split_once('$')?;
        let (number, rest) = rest.split_at(rest.find('$').unwrap_or(rest.len()));
        let (_, names) = self.names.iter().find(|(name, _)| *name == field)?;
        Some((field, names.get(number.parse::<usize>().ok()?)?.as_str(), rest))
    }
}

/// A block, or a field of one, that says what it is. Signals, constants and registers have nothing to say.
pub trait Circuit: Block {
    /// Hands over the descriptions of this and all parts; `key` is what the block that this is a part of calls it.
    fn describe(&self, key: &str, found: &mut Descriptions) {
        let _ = (key, found);
    }
}

impl<D: Direction, T: Synth> Circuit for Signal<D, T> {}
impl<T: Synth> Circuit for Constant<T> {}
impl<T: Synth> Circuit for DFF<T> {}
impl<T: Synth + BitXor<Output = T>> Circuit for DFFWithInit<T> {}

impl<C: Circuit> Circuit for Vec<C> {
    fn describe(&self, key: &str, found: &mut Descriptions) {
        describe_each(self, key, found);
    }
}

impl<C: Circuit, const N: usize> Circuit for [C; N] {
    fn describe(&self, key: &str, found: &mut Descriptions) {
        describe_each(self, key, found);
    }
}

/// Elements have the keys that rust-hdl gives them.
fn describe_each<C: Circuit>(parts: &[C], key: &str, found: &mut Descriptions) {
    parts.iter().enumerate().for_each(|(i, part)| part.describe(&format!("{key}${i}"), found));
}

/// What registers do before the kernel: they take their clock and keep their values. Written by `#[circuit(registers(…))]`.
pub trait Holds {
    /// As in `Logic`.
    fn update(&mut self);
    /// As in `Logic`.
    fn connect(&mut self);
    /// As in `Logic`.
    fn hdl(&self) -> Verilog;
}

/// What registers do after the kernel: they are reset. Written by `#[circuit(registers(…))]`.
pub trait Resets {
    /// As in `Logic`.
    fn update(&mut self);
    /// As in `Logic`.
    fn connect(&mut self);
    /// As in `Logic`.
    fn hdl(&self) -> Verilog;
}

/// The descriptions of all blocks of a circuit.
#[derive(Debug, Default)]
pub struct Descriptions {
    open: Vec<String>,
    found: HashMap<String, Description>,
    around: HashMap<String, [Verilog; 2]>,
}

impl Descriptions {
    /// Those of a circuit that is called `key`.
    #[must_use]
    pub fn of(circuit: &dyn Circuit, key: &str) -> Self {
        let mut found = Self::default();
        circuit.describe(key, &mut found);
        found
    }

    /// Adds a block and what `parts` adds.
    pub fn block(&mut self, key: &str, description: Description, parts: impl FnOnce(&mut Self)) {
        self.open.push(key.into());
        self.found.insert(self.open.join("."), description);
        parts(self);
        self.open.pop();
    }

    /// Adds what happens before and after the kernel of the block that is being described.
    pub fn around(&mut self, before: Verilog, after: Verilog) {
        self.around.insert(self.open.join("."), [before, after]);
    }

    /// The kernel of a block with what happens before and after it.
    #[must_use]
    pub fn whole(&self, path: &str, kernel: Verilog) -> Verilog {
        match (self.around.get(path), kernel) {
            (
                Some([Verilog::Combinatorial(before), Verilog::Combinatorial(after)]),
                Verilog::Combinatorial(kernel),
            ) => Verilog::Combinatorial([before.clone(), kernel, after.clone()].concat()),
            (_, kernel) => kernel,
        }
    }

    /// The description of the block with these keys, from the top down, dots between them.
    #[must_use]
    pub fn get(&self, path: &str) -> Option<Description> {
        self.found.get(path).cloned()
    }
}
