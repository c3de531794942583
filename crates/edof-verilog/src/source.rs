//! The syntax tree quoted in error messages, and its literals and indices read back as numbers.

use rust_hdl::prelude::VerilogLiteral;
use rust_hdl::prelude::ast::{VerilogExpression as Source, VerilogOp as Op, VerilogOpUnary as Unary};

use crate::error::rust_path;

/// The expression nearly as the kernel has it.
pub(crate) fn quote(source: &Source) -> String {
    match source {
        Source::Signal(name) => rust_path(name),
        Source::Literal(literal) => {
            number(literal).map_or_else(|| literal.to_string(), |value| value.to_string())
        }
        Source::Cast(inner, bits) => format!("bit_cast::<{bits}, _>({})", quote(inner)),
        Source::Signed(inner) => format!("signed({})", quote(inner)),
        Source::Unsigned(inner) => format!("unsigned_cast({})", quote(inner)),
        Source::Paren(inner) => format!("({})", quote(inner)),
        Source::Binary(left, op, right) => format!("{} {} {}", quote(left), symbol(op), quote(right)),
        Source::Unary(Unary::Not, inner) => format!("!{}", quote(inner)),
        Source::Unary(Unary::Neg, inner) => format!("-{}", quote(inner)),
        Source::Unary(Unary::All, inner) => format!("{}.all()", quote(inner)),
        Source::Unary(Unary::Any, inner) => format!("{}.any()", quote(inner)),
        Source::Unary(Unary::Xor, inner) => format!("{}.xor()", quote(inner)),
        Source::Index(inner, index) => format!("{}.get_bit({})", quote(inner), quote(index)),
        Source::Slice(inner, bits, at) => format!("{}.get_bits::<{bits}>({})", quote(inner), quote(at)),
        Source::IndexReplace(inner, index, bit) => {
            format!("{}.replace_bit({}, {})", quote(inner), quote(index), quote(bit))
        }
    }
}

/// The operator in Rust and in Verilog.
pub(crate) fn symbol(op: &Op) -> &'static str {
    match op {
        Op::Add => "+",
        Op::Sub => "-",
        Op::Mul => "*",
        Op::LogicalAnd => "&&",
        Op::LogicalOr => "||",
        Op::BitXor => "^",
        Op::BitAnd => "&",
        Op::BitOr => "|",
        Op::Shl => "<<",
        Op::Shr => ">>",
        Op::Eq => "==",
        Op::Lt => "<",
        Op::Le => "<=",
        Op::Ne => "!=",
        Op::Ge => ">=",
        Op::Gt => ">",
    }
}

/// The value of a literal, whose fields rust-hdl keeps to itself: it prints as `32'h-5`.
pub(crate) fn number(literal: &VerilogLiteral) -> Option<i128> {
    let text = format!("{literal:x}");
    i128::from_str_radix(text.split_once("'h")?.1, 16).ok()
}

/// Whether the literal is a `bool`: the only one of a single bit that a kernel can write.
pub(crate) fn is_bool(literal: &VerilogLiteral) -> bool {
    format!("{literal:x}").starts_with("1'h")
}

/// A whole number as Rust writes it: `12`, `0xff`, `0b1_0`, `7_usize`; `true` and `false` too.
pub(crate) fn rust_number(text: &str) -> Option<i128> {
    let text: String = text.chars().filter(|c| !c.is_whitespace() && *c != '_').collect();
    match text.as_str() {
        "true" => return Some(1),
        "false" => return Some(0),
        _ => {}
    }
    if let Some(rest) = text.strip_prefix('-') {
        return rust_number(rest).map(|value| -value);
    }
    let (digits, radix) = match text.get(..2) {
        Some("0x") => (&text[2..], 16),
        Some("0b") => (&text[2..], 2),
        Some("0o") => (&text[2..], 8),
        _ => (text.as_str(), 10),
    };
    let suffixes = ["usize", "isize", "u128", "i128", "u64", "i64", "u32", "i32", "u16", "i16", "u8", "i8"];
    let bare = suffixes.iter().find_map(|suffix| digits.strip_suffix(suffix)).unwrap_or(digits);
    i128::from_str_radix(bare, radix).ok()
}

/// An array index such as `2*i+1`, with the loop variables' values.
pub(crate) fn index(text: &str, loops: &[(String, i128)]) -> Option<i128> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let mut reader = Index { rest: &text, loops };
    let value = reader.sum()?;
    reader.rest.is_empty().then_some(value)
}

/// Recursive descent over `+ - * / %` and parentheses.
struct Index<'a> {
    rest: &'a str,
    loops: &'a [(String, i128)],
}

impl Index<'_> {
    fn sum(&mut self) -> Option<i128> {
        let mut value = self.product()?;
        while let Some(op) = self.one_of("+-") {
            let right = self.product()?;
            value = if op == '+' { value.checked_add(right)? } else { value.checked_sub(right)? };
        }
        Some(value)
    }

    fn product(&mut self) -> Option<i128> {
        let mut value = self.atom()?;
        while let Some(op) = self.one_of("*/%") {
            let right = self.atom()?;
            value = match op {
                '*' => value.checked_mul(right)?,
                '/' => value.checked_div(right)?,
                _ => value.checked_rem(right)?,
            };
        }
        Some(value)
    }

    fn atom(&mut self) -> Option<i128> {
        if self.one_of("(").is_some() {
            let value = self.sum()?;
            return self.one_of(")").map(|_| value);
        }
        let end = self.rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        let variable = self.loops.iter().rev().find(|(name, _)| name == word);
        variable.map(|(_, value)| *value).or_else(|| rust_number(word))
    }

    fn one_of(&mut self, set: &str) -> Option<char> {
        let first = self.rest.chars().next().filter(|c| set.contains(*c))?;
        self.rest = &self.rest[1..];
        Some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_arithmetic_of_loop_variables() {
        let loops = [("i".to_string(), 3), ("j".to_string(), 5)];
        assert_eq!(index("2*i+1", &loops), Some(7));
        assert_eq!(index("(i + 1) * (j - 2) / 2 % 4", &loops), Some(2));
        assert_eq!(index("i + N", &loops), None);
    }

    #[test]
    fn literals_are_read_back() {
        assert_eq!(number(&VerilogLiteral::from(-5)), Some(-5));
        assert_eq!(number(&VerilogLiteral::from(0xdead_beef_u64)), Some(0xdead_beef));
        assert!(is_bool(&VerilogLiteral::from(true)) && !is_bool(&VerilogLiteral::from(1)));
        assert_eq!(rust_number("0x1_F_usize"), Some(31));
    }
}
