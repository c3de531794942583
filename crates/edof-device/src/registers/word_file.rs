//! Words for the calculator's memories as a file, for a host of one's own.

use std::fmt::Write;
use std::path::Path;

/// Format of a file of addresses and words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WordFormat {
    /// Text: address and word in hexadecimal, a pair on each line. `$readmemh` reads it as one number after the other.
    Hex,
    /// Address and word as 32 bits each, the lowest byte first.
    Binary,
    /// An array of pairs in C.
    Header,
}

impl WordFormat {
    /// Endings of files, and what they stand for.
    const ENDINGS: [(&str, Self); 3] = [("hex", Self::Hex), ("bin", Self::Binary), ("h", Self::Header)];

    /// Returns the format that the ending of a file's name stands for.
    #[must_use]
    pub fn of_ending(file: &Path) -> Option<Self> {
        let ending = file.extension()?;
        Self::ENDINGS.into_iter().find(|(known, _)| ending == *known).map(|(_, format)| format)
    }

    /// Returns a file of pairs of address and word. `about` says in a header what they are.
    ///
    /// ```
    /// use edof_device::registers::word_file::WordFormat;
    /// let words = [(0x0020_0001, 0xffff_0001)];
    /// assert_eq!(WordFormat::Hex.file("", &words), b"0200001 ffff0001\n");
    /// assert_eq!(WordFormat::Binary.file("", &words), [1, 0, 0x20, 0, 1, 0, 0xff, 0xff]);
    /// ```
    #[must_use]
    pub fn file(self, about: &str, words: &[(u32, u32)]) -> Vec<u8> {
        match self {
            Self::Hex => lines(words, |address, word| format!("{address:07x} {word:08x}")).into_bytes(),
            Self::Binary => words
                .iter()
                .flat_map(|(address, word)| [*address, *word])
                .flat_map(u32::to_le_bytes)
                .collect(),
            Self::Header => header(about, words).into_bytes(),
        }
    }
}

fn lines(words: &[(u32, u32)], line: impl Fn(u32, u32) -> String) -> String {
    words.iter().fold(String::new(), |mut text, (address, word)| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", line(*address, *word));
        text
    })
}

fn header(about: &str, words: &[(u32, u32)]) -> String {
    let pairs = lines(words, |address, word| format!("  {{ 0x{address:07x}u, 0x{word:08x}u }},"));
    format!(
        "/* {about} Generated; do not edit. */\n#ifndef EDOF_WORDS_H\n#define EDOF_WORDS_H\n\n#include <stdint.h>\n\n\
         #define EDOF_WORDS_COUNT {}u\n\n/* Address (write_address_i) and word (write_data_i). */\n\
         static const uint32_t EDOF_WORDS[EDOF_WORDS_COUNT][2] = {{\n{pairs}}};\n\n#endif\n",
        words.len()
    )
}
