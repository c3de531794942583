//! The map as a page for people.

use super::map::{REGISTERS, WINDOWS};
use std::fmt::Write;

/// The page.
#[must_use]
pub fn page() -> String {
    let mut text = String::from(
        "# Registers\n\nWords of 32 bits at byte addresses. `r` can be read, `w` written. Bits that are not listed read 0.\n\n\
         | address | name | access | reset | what |\n|---|---|---|---|---|\n",
    );
    for register in REGISTERS {
        let (letters, reset) = (register.access.letters(), register.reset);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| `0x{:03x}` | `{}` | {letters} | `0x{reset:x}` | {} |",
            register.address, register.name, register.doc
        );
    }
    for register in REGISTERS.iter().filter(|register| !register.fields.is_empty()) {
        let _ = write!(text, "\n## `{}`\n\n| bits | field | what |\n|---|---|---|\n", register.name);
        for field in register.fields {
            let high = field.low + field.bits - 1;
            let bits =
                if field.bits == 1 { field.low.to_string() } else { format!("{high}…{}", field.low) };
            let _ = writeln!(text, "| {bits} | `{}` | {} |", field.name, field.doc);
        }
    }
    text += "\n## Windows\n\n| address | size | name | access | what |\n|---|---|---|---|---|\n";
    for window in WINDOWS {
        let letters = window.access.letters();
        let _ = writeln!(
            text,
            "| `0x{:08x}` | `0x{:x}` | `{}` | {letters} | {} |",
            window.address, window.bytes, window.name, window.doc
        );
    }
    text
}
