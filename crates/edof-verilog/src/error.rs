//! What the backend rejects, and where.

use crate::types::Type;

/// A circuit that cannot be translated exactly: where it stands, and what is wrong with it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{block}{}{field}: {fault}", if field.is_empty() { "" } else { "." })]
pub struct EmitError {
    /// Path of the block, for instance `top.stages[3].mac`.
    pub block: String,
    /// The signal that is driven where the fault stands; empty where the block as a whole is meant.
    pub field: String,
    /// What is wrong.
    pub fault: Fault,
}

/// What can be wrong with a circuit. Expressions are quoted in the words of the syntax tree.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum Fault {
    /// A block that does not derive [`Circuit`](crate::describe::Circuit).
    #[error("has no description; #[derive(Circuit)] gives it one")]
    Undescribed,
    /// A block whose `hdl()` is not a kernel.
    #[error("its hdl() is {0}; only #[hdl_gen] kernels, registers and leaves are translated")]
    NotAKernel(&'static str),
    /// The top block must be a module of its own.
    #[error("is a leaf or a register and cannot be the top")]
    NotATop,
    /// A leaf that names a field it does not have.
    #[error("the leaf `{leaf}` connects the field `{port}`, which the block does not have")]
    LeafPort { leaf: String, port: String },
    /// A leaf whose own text is not understood.
    #[error("the text of its leaf cannot be read: {0}")]
    LeafText(String),
    /// A leaf whose text says something else than the block.
    #[error("the leaf `{leaf}` {what}")]
    LeafMisfit { leaf: String, what: String },
    /// A leaf's parameter that does not have the value of its formula.
    #[error("the leaf has {found}, and `{formula}` is {value}")]
    Formula { found: String, formula: String, value: u64 },
    /// A formula without a whole number, which Verilog computes in too few bits.
    #[error(
        "`{0}` is computed in as many bits as its constants have; a number or a constant that no kernel reads makes it whole"
    )]
    NarrowFormula(String),
    /// A bidirectional port.
    #[error("bidirectional ports are not translated")]
    InOut,
    /// A signal without bits, such as an enum of one state.
    #[error("has no bits")]
    NoBits,
    /// A name that is neither signal, state nor loop variable.
    #[error("`{0}` is neither a signal, a state nor a loop variable; constants belong into a Constant<T>")]
    Unknown(String),
    /// A state whose name means different things in one block.
    #[error("the state `{0}` has two meanings in this block")]
    TwoMeanings(String),
    /// An array index other than whole-number arithmetic of loop variables.
    #[error("the index `{0}` is not arithmetic of numbers and loop variables")]
    Index(String),
    /// Operand or value of the wrong type.
    #[error("`{expression}` is {found}, where {wanted} is needed")]
    Mismatch { expression: String, found: Type, wanted: Type },
    /// A literal that the type of its peer or target cannot hold.
    #[error("{value} does not fit {wanted}")]
    Misfit { value: String, wanted: Type },
    /// A cast or literal whose context does not determine its width.
    #[error("the width of `{0}` follows from nothing around it; assign it to a signal first")]
    Ambiguous(String),
    /// An operation that Rust does not have for this operand.
    #[error("`{expression}`: {reason}")]
    Operand { expression: String, reason: &'static str },
    /// A constant bit index or offset outside of its operand: Rust panics there.
    #[error("`{0}` reaches outside of its operand")]
    OutOfRange(String),
    /// A pattern of a match that is neither state nor literal.
    #[error("the pattern `{0}` is neither a state nor a literal")]
    Pattern(String),
    /// Something that a kernel cannot drive, such as its own input.
    #[error("is not driven from here")]
    NotDrivable,
    /// An output, an input of a child or a signal that is read, and nothing drives it.
    #[error("is never driven")]
    Undriven,
    /// A signal that is not driven on every path: a latch.
    #[error("is not driven on every path, which would be a latch")]
    Latch,
    /// A signal read before it is written, which means different things in Rust and in Verilog.
    #[error("`{0}` is read before it is written")]
    ReadBeforeWrite(String),
    /// A signal that depends on itself without a register between.
    #[error("depends on itself without a register between: {0}")]
    Cycle(String),
    /// Clocks of registers are plain signals.
    #[error("a clock must be driven once, by a plain signal")]
    Clock,
    /// A path from one clock domain to another without a leaf that is declared a crossing.
    #[error("leads from the domain of `{0}` to that of `{1}` without a synchroniser")]
    Crossing(String, String),
    /// A leaf of several clocks must be declared a crossing ([`Leaf::crossing`](crate::leaf::Leaf::crossing)).
    #[error("the leaf `{0}` has several clocks and is no crossing")]
    Clocks(String),
    /// Statements that depend on nothing are never started by `always @*`.
    #[error("is driven by statements that depend on no signal; write one assignment")]
    Constant,
}

impl EmitError {
    /// A fault of a block as a whole.
    pub(crate) fn block(block: &str, fault: Fault) -> Self {
        Self { block: block.into(), field: String::new(), fault }
    }

    /// A fault at a signal of a block.
    pub(crate) fn field(block: &str, field: &str, fault: Fault) -> Self {
        Self { block: block.into(), field: rust_path(field), fault }
    }
}

/// rust-hdl's name for a signal, `banks$3$data`, as Rust writes it: `banks[3].data`.
#[must_use]
pub fn rust_path(key: &str) -> String {
    let mut words = key.split('$');
    let mut path = words.next().unwrap_or_default().to_string();
    for word in words {
        let index = !word.is_empty() && word.bytes().all(|b| b.is_ascii_digit());
        path += &if index { format!("[{word}]") } else { format!(".{word}") };
    }
    path
}
