//! Values that a module can be given from outside: of its constants, of its leaves' parameters, of its loops' ends.

use crate::expression::wrap;
use crate::text::{Use, literal};
use crate::types::Type;

/// A value as Verilog writes it, and the type that a parameter of it is declared with.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Value {
    /// `[11:0] `, or nothing for whole numbers and text.
    pub of_type: String,
    pub text: String,
}

impl Value {
    /// A whole number.
    pub fn number(number: usize) -> Self {
        Self::plain(number.to_string())
    }

    /// A whole number from hexadecimal digits; those of a long one stand in threes.
    pub fn whole(digits: &str) -> Self {
        let digits =
            u64::from_str_radix(digits, 16).map_or_else(|_| digits.into(), |number| number.to_string());
        if digits.len() < 5 {
            return Self::plain(digits);
        }
        let groups: Vec<&str> =
            digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
        Self::plain(groups.join("_"))
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
pub(crate) fn pattern(ty: Type, digits: &str, of: Use) -> String {
    let digits = digits.trim_start_matches('0');
    let digits = if digits.is_empty() { "0" } else { digits };
    match i128::from_str_radix(digits, 16) {
        Ok(value) if ty.bits < 100 => literal(ty, wrap(value, ty), of),
        _ => format!("{}'{}h{digits}", ty.bits, if ty.signed { "s" } else { "" }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_decimal_and_masks_hexadecimal() {
        let written = [
            pattern(Type::bits(13), "780", Use::Count),
            pattern(Type::bits(13), "780", Use::Mask),
            pattern(Type::bits(7), "7f", Use::Value),
            pattern(Type::bits(1), "1", Use::Mask),
            pattern(Type::bits(48), "ffffffff0000", Use::Count),
            pattern(Type::signed(16), "fed4", Use::Value),
            pattern(Type::bits(4), "0", Use::Value),
        ];
        let wanted = ["13'd1920", "13'h780", "7'h7f", "1'b1", "48'hffffffff0000", "-16'sd300", "4'd0"];
        assert_eq!(written, wanted);
    }
}
