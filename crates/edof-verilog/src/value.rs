//! Values that a module can be given from outside: of its constants, of its leaves' parameters, of its loops' ends.

use crate::types::Type;

/// A value as Verilog writes it, and the type that a parameter of it is declared with.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Value {
    /// `[11:0] `, or nothing for whole numbers and text.
    pub of_type: String,
    pub text: String,
}

impl Value {
    /// A constant from its hexadecimal digits: a small one in decimal.
    pub fn constant(ty: Type, digits: &str) -> Self {
        Self { of_type: of_type(ty), text: pattern(ty, digits) }
    }

    /// A whole number.
    pub fn number(number: usize) -> Self {
        Self::plain(number.to_string())
    }

    /// What a leaf's parameter is given.
    pub fn plain(text: String) -> Self {
        Self { of_type: String::new(), text }
    }
}

/// `signed [15:0] ` before a name; nothing for one bit.
pub(crate) fn of_type(ty: Type) -> String {
    let signed = if ty.signed { "signed " } else { "" };
    let range = if ty.bits > 1 { format!("[{}:0] ", ty.bits - 1) } else { String::new() };
    signed.to_string() + &range
}

/// A constant from its hexadecimal digits.
pub(crate) fn pattern(ty: Type, digits: &str) -> String {
    let (bits, sign) = (ty.bits, if ty.signed { "s" } else { "" });
    let digits = digits.trim_start_matches('0');
    match u64::from_str_radix(if digits.is_empty() { "0" } else { digits }, 16) {
        Ok(value) if value < 1000 && !ty.signed => match bits {
            1 => format!("1'b{value}"),
            _ => format!("{bits}'d{value}"),
        },
        _ => format!("{bits}'{sign}h{}", if digits.is_empty() { "0" } else { digits }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_constants_are_decimal() {
        let written = [
            pattern(Type::bits(12), "008"),
            pattern(Type::bits(1), "1"),
            pattern(Type::bits(48), "ffffffff0000"),
            pattern(Type::signed(16), "fed4"),
            pattern(Type::bits(4), "0"),
        ];
        assert_eq!(written, ["12'd8", "1'b1", "48'hffffffff0000", "16'shfed4", "4'd0"]);
    }
}
