//! The type of a signal or expression: how many bits, and whether the first one is a sign.

use std::fmt;

/// Width and signedness. `Bit`, `Clock` and enums are unsigned here, as they are in Verilog.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Type {
    /// Width in bits.
    pub bits: usize,
    /// Two's complement.
    pub signed: bool,
}

impl Type {
    /// One bit, the type of conditions.
    pub(crate) const BIT: Self = Self::bits(1);

    /// `Bits<bits>`.
    pub(crate) const fn bits(bits: usize) -> Self {
        Self { bits, signed: false }
    }

    /// `Signed<bits>`.
    pub(crate) const fn signed(bits: usize) -> Self {
        Self { bits, signed: true }
    }

    /// The same signedness at another width.
    pub(crate) const fn with_bits(self, bits: usize) -> Self {
        Self { bits, ..self }
    }

    /// Whether the type has this value.
    pub(crate) fn holds(self, value: i128) -> bool {
        let magnitude = if self.signed { self.bits - 1 } else { self.bits };
        let top = if magnitude >= 127 { i128::MAX } else { (1 << magnitude) - 1 };
        let bottom = if self.signed { -top - 1 } else { 0 };
        (bottom..=top).contains(&value)
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}<{}>", if self.signed { "Signed" } else { "Bits" }, self.bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_type_holds_what_its_bits_can_say() {
        assert!(Type::bits(8).holds(255) && !Type::bits(8).holds(256) && !Type::bits(8).holds(-1));
        assert!(Type::signed(8).holds(-128) && !Type::signed(8).holds(128));
        assert!(Type::bits(128).holds(i128::MAX) && Type::signed(128).holds(i128::MIN));
    }
}
