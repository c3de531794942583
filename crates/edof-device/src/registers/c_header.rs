//! The map as constants for C.

use super::capitals;
use super::map::{ID, REGISTERS, VERSION, WINDOWS};
use std::fmt::Write;

/// The header: an address for each register and window, and shift and mask for each field.
#[must_use]
pub fn header() -> String {
    let mut text = String::from(
        "/* Registers of the edof board: byte addresses of 32-bit words. Generated; do not edit. */\n\
         #ifndef EDOF_REGISTERS_H\n#define EDOF_REGISTERS_H\n\n",
    );
    // Writing to a String cannot fail.
    let _ =
        writeln!(text, "#define EDOF_ID_VALUE 0x{ID:08x}u\n#define EDOF_VERSION_VALUE 0x{VERSION:08x}u\n");
    for register in REGISTERS {
        let name = capitals(register.name);
        let _ = writeln!(text, "/* {} */\n#define EDOF_{name} 0x{:08x}u", register.doc, register.address);
        for field in register.fields {
            let field_name = capitals(field.name);
            let _ = writeln!(text, "#define EDOF_{name}_{field_name}_SHIFT {}", field.low);
            let _ = writeln!(text, "#define EDOF_{name}_{field_name}_MASK 0x{:08x}u", field.mask());
        }
    }
    for window in WINDOWS {
        let name = capitals(window.name);
        let _ = writeln!(text, "/* {} */\n#define EDOF_{name} 0x{:08x}u", window.doc, window.address);
        let _ = writeln!(text, "#define EDOF_{name}_BYTES 0x{:08x}u", window.bytes);
    }
    text + "\n#endif\n"
}
