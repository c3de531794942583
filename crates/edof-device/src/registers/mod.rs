//! What the host sees of the board: every register and every memory, at which address, and what its bits mean.
//!
//! | what | module |
//! |---|---|
//! | the registers and windows themselves | [`map`] |
//! | hashes of a design and of a network | [`identity`] |
//! | a page for people | [`markdown`] |
//! | constants for C | [`c_header`] |
//! | SystemRDL 2.0, for other tools | [`systemrdl`] |
//! | words of a network, for other hosts | [`word_file`] |
//!
//! Addresses are of bytes, words have 32 bits. Rust takes its constants from [`map`] directly, and the circuit its decoder.

pub mod c_header;
pub mod csr_csv;
pub mod identity;
pub mod map;
pub mod markdown;
pub mod systemrdl;
pub mod word_file;

/// What the host can do with a register or a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Read what the design was generated with.
    Constant,
    /// Read what the board says.
    Status,
    /// Write, and read back what was written.
    Control,
    /// Write; reading is answered with an error.
    WriteOnly,
}

impl Access {
    /// In the words of SystemRDL: `r`, `rw` or `w`.
    #[must_use]
    pub const fn letters(self) -> &'static str {
        match self {
            Self::Constant | Self::Status => "r",
            Self::Control => "rw",
            Self::WriteOnly => "w",
        }
    }
}

/// One word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Register {
    /// In small letters with underscores: a name in Rust, C and Verilog.
    pub name: &'static str,
    /// Byte address.
    pub address: u32,
    /// What the host can do with it.
    pub access: Access,
    /// Value after reset, of a [`Access::Control`] register; of a constant, if it is the same in all designs.
    pub reset: u32,
    /// What it is.
    pub doc: &'static str,
    /// Parts of the word, from bit 0 on; none where the word is one number.
    pub fields: &'static [Field],
}

/// Some bits of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Name of the field, unique in the register.
    pub name: &'static str,
    /// Lowest bit.
    pub low: u32,
    /// How many bits.
    pub bits: u32,
    /// What it is.
    pub doc: &'static str,
}

impl Field {
    /// Mask of the field in the word.
    #[must_use]
    pub const fn mask(&self) -> u32 {
        (((1u64 << self.bits) - 1) << self.low) as u32
    }
}

impl Register {
    /// The bits that mean something: all of a word without fields.
    #[must_use]
    pub fn mask(&self) -> u32 {
        if self.fields.is_empty() { u32::MAX } else { self.fields.iter().map(Field::mask).sum() }
    }

    /// A field by its name.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.name == name)
    }
}

/// Many words that are one memory to the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// In small letters with underscores.
    pub name: &'static str,
    /// Byte address, a multiple of its size.
    pub address: u32,
    /// Size in bytes, a power of two.
    pub bytes: u32,
    /// What the host can do with it.
    pub access: Access,
    /// What it holds, and at which word.
    pub doc: &'static str,
}

impl Window {
    /// Bits of the number of a word in it.
    #[must_use]
    pub const fn word_bits(&self) -> u32 {
        self.bytes.trailing_zeros() - 2
    }

    /// Byte address of a word in it.
    #[must_use]
    pub const fn word(&self, index: u32) -> u32 {
        self.address + 4 * index
    }
}

/// The name in capitals, for C.
fn capitals(name: &str) -> String {
    name.to_uppercase()
}
