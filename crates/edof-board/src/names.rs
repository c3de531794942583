//! Registers by name: `status`, `control.colour` for a field, `stage_counters[4]` for a word of a window.

use crate::error::Error;
use edof_device::registers::map::{REGISTERS, WINDOWS, register};
use edof_device::registers::{Access, Field, Register, Window};
use std::str::FromStr;

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A whole register.
    Register(&'static Register),
    /// Some bits of one.
    Field(&'static Register, &'static Field),
    /// A word of a window.
    Word(&'static Window, u32),
}

impl FromStr for Place {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let unknown = || Error::NoRegister { name: name.into() };
        if let Some((window, index)) = name.strip_suffix(']').and_then(|name| name.split_once('[')) {
            let window = WINDOWS.iter().find(|known| known.name == window).ok_or_else(unknown)?;
            let max = window.bytes / 4 - 1;
            let word = number(index).filter(|index| *index <= max);
            let wrong = || Error::NoWord { window: window.name.into(), index: index.into(), max };
            return Ok(Self::Word(window, word.ok_or_else(wrong)?));
        }
        let (whole, part) = name.split_once('.').map_or((name, None), |(whole, part)| (whole, Some(part)));
        let whole = register(whole).ok_or_else(unknown)?;
        let Some(part) = part else { return Ok(Self::Register(whole)) };
        let known = || whole.fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
        let wrong = || Error::NoField { register: whole.name.into(), field: part.into(), fields: known() };
        Ok(Self::Field(whole, whole.field(part).ok_or_else(wrong)?))
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Register(register) => write!(f, "{}", register.name),
            Self::Field(register, field) => write!(f, "{}.{}", register.name, field.name),
            Self::Word(window, index) => write!(f, "{}[{index}]", window.name),
        }
    }
}

impl Place {
    /// Every register, in the order of their addresses.
    pub fn registers() -> impl Iterator<Item = Self> {
        REGISTERS.iter().map(Self::Register)
    }

    /// Byte address of its word.
    #[must_use]
    pub const fn address(&self) -> u32 {
        match self {
            Self::Register(register) | Self::Field(register, _) => register.address,
            Self::Word(window, index) => window.word(*index),
        }
    }

    const fn access(&self) -> Access {
        match self {
            Self::Register(register) | Self::Field(register, _) => register.access,
            Self::Word(window, _) => window.access,
        }
    }

    /// # Errors
    /// The register can only be written.
    pub fn check_read(&self) -> Result<(), Error> {
        match self.access() {
            Access::WriteOnly => Err(Error::OneWay { name: self.to_string(), only: "written" }),
            _ => Ok(()),
        }
    }

    /// Whether what is written can be read.
    #[must_use]
    pub const fn reads_back(&self) -> bool {
        matches!(self.access(), Access::Control)
    }

    /// The field's part of its word.
    #[must_use]
    pub const fn of_word(&self, word: u32) -> u32 {
        match self {
            Self::Field(_, field) => (word & field.mask()) >> field.low,
            _ => word,
        }
    }

    /// The word that holds the value, all else as in `word`.
    ///
    /// # Errors
    /// The register can only be read, or the value has more bits than the field.
    pub fn into_word(&self, value: u32, word: u32) -> Result<u32, Error> {
        if matches!(self.access(), Access::Constant | Access::Status) {
            return Err(Error::OneWay { name: self.to_string(), only: "read" });
        }
        let refused = |expected: String| {
            Err(Error::Value { name: self.to_string(), value: format!("0x{value:x}"), expected })
        };
        match self {
            Self::Field(_, field) if value > field.mask() >> field.low => {
                refused(format!("0 to {}", field.mask() >> field.low))
            }
            Self::Field(_, field) => Ok((word & !field.mask()) | value << field.low),
            Self::Register(register) if value & !register.mask() != 0 => {
                refused(format!("without bits outside of 0x{:x}", register.mask()))
            }
            _ => Ok(value),
        }
    }
}

/// A number as people write it: decimal, or hexadecimal after `0x`.
#[must_use]
pub fn number(text: &str) -> Option<u32> {
    match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(name: &str) -> String {
        name.parse::<Place>().unwrap_err().to_string()
    }

    #[test]
    fn a_name_stands_for_a_register_a_field_or_a_word() {
        for name in ["control", "control.colour", "stage_counters[5]"] {
            assert_eq!(name.parse::<Place>().unwrap().to_string(), name);
        }
        assert_eq!("weights[0x10]".parse::<Place>().unwrap().address(), 0x0800_0040);
        assert!(refused("contrl").contains("'contrl': there is none"));
        assert!(refused("control.color").contains("control has the fields run, colour, weight_set"));
        assert!(refused("scratch.low").contains("scratch has no fields"));
        assert!(refused("stage_reads[64]").contains("a word from 0 to 63"));
    }

    #[test]
    fn a_value_goes_where_its_field_is_and_nowhere_else() {
        let colour: Place = "control.colour".parse().unwrap();
        assert_eq!((colour.into_word(0, 0b111).unwrap(), colour.of_word(0b010)), (0b101, 1));
        assert!(colour.into_word(2, 0).unwrap_err().to_string().contains("must be 0 to 1"));
        let whole: Place = "control".parse().unwrap();
        assert!(whole.into_word(32, 0).unwrap_err().to_string().contains("without bits outside of 0x1f"));
        let status: Place = "status".parse().unwrap();
        assert!(status.into_word(0, 0).unwrap_err().to_string().contains("can only be read"));
        let table: Place = "display_tables[0]".parse().unwrap();
        assert!(table.check_read().unwrap_err().to_string().contains("can only be written"));
    }
}
