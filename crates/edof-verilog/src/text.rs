//! Pieces of Verilog text: expressions with what stands outermost in them, literals, ranges.

use crate::types::Type;

/// Text of an expression, what it is outside, and whether Verilog takes it for signed.
pub(crate) struct Text {
    pub text: String,
    pub form: Form,
    pub signed: bool,
}

/// What stands outermost in an expression.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// A name, a literal, braces: complete in itself.
    Atom,
    /// `!` or `~` before an atom: needs no parentheses, but is as wide as what is around it.
    Not,
    /// Operands between which this stands, in any order of operations the same.
    Chain(&'static str),
    Operation,
}

/// Operations that need no parentheses between their like.
const CHAINS: [&str; 6] = ["+", "&", "|", "^", "&&", "||"];

impl Text {
    pub fn atom(text: String, signed: bool) -> Self {
        Self { text, form: Form::Atom, signed }
    }

    pub fn operation(text: String, signed: bool) -> Self {
        Self { text, form: Form::Operation, signed }
    }

    pub fn binary(op: &'static str, left: Self, right: Self) -> Self {
        let signed = left.signed && right.signed;
        let chains = CHAINS.contains(&op);
        let left = if chains && left.form == Form::Chain(op) { left.text } else { left.operand() };
        let form = if chains { Form::Chain(op) } else { Form::Operation };
        Self { text: format!("{left} {op} {}", right.operand()), form, signed }
    }

    pub fn operand(self) -> String {
        match self.form {
            Form::Atom | Form::Not => self.text,
            Form::Chain(_) | Form::Operation => format!("({})", self.text),
        }
    }

    /// After one sign there is no second one in Verilog.
    pub fn unary_operand(self) -> String {
        if self.form == Form::Atom { self.text } else { format!("({})", self.text) }
    }
}

pub(crate) fn convert(text: Text, signed: bool) -> String {
    format!("{}({})", if signed { "$signed" } else { "$unsigned" }, text.text)
}

/// `[7:0]`, `[3]`.
pub(crate) fn range(at: usize, bits: usize) -> String {
    if bits == 1 { format!("[{at}]") } else { format!("[{}:{at}]", at + bits - 1) }
}

/// What a number is for: lengths and counts are decimal, masks hexadecimal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Use {
    /// Assigned or chosen: hexadecimal only where all of at least four bits are ones, and for extremes.
    Value,
    /// Compared, added, taken away.
    Count,
    /// Joined bit by bit.
    Mask,
}

/// Numbers from here on are hexadecimal whatever they are for.
const LONG: i128 = 1_000_000;

/// A sized literal.
pub(crate) fn literal(ty: Type, value: i128, of: Use) -> String {
    let bits = ty.bits;
    let is_full = (4..100).contains(&bits) && value == (1 << bits) - 1;
    // The largest and the smallest number of two's complement.
    let is_extreme = (16..100).contains(&bits) && [0, 1].contains(&((1 << (bits - 1)) - value));
    let is_decimal = match of {
        Use::Value => value < LONG && !is_full && !is_extreme,
        Use::Count => value < LONG,
        Use::Mask => value < 10,
    };
    match (ty.signed, value) {
        (false, _) if bits == 1 => format!("1'b{value}"),
        (false, _) if is_decimal => format!("{bits}'d{value}"),
        (false, _) => format!("{bits}'h{value:x}"),
        (true, 0..) => format!("{bits}'sd{value}"),
        (true, _) => format!("-{bits}'sd{}", value.unsigned_abs()),
    }
}
