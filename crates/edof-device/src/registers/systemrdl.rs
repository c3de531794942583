//! The map in SystemRDL 2.0 (Accellera).

use super::map::{REGISTERS, WINDOWS};
use super::{Access, Register};
use std::fmt::Write;

/// The address map `edof`.
#[must_use]
pub fn address_map() -> String {
    let mut text = String::from(
        "// Registers of the edof board. Generated; do not edit.\naddrmap edof {\n    default regwidth = 32;\n\n",
    );
    REGISTERS.iter().for_each(|register| add(&mut text, register));
    for window in WINDOWS {
        let words = window.bytes / 4;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "    external mem {{\n        desc = \"{}\";\n        mementries = {words};\n        memwidth = 32;\n        sw = {};\n    }} {} @ 0x{:x};\n",
            escaped(window.doc),
            window.access.letters(),
            window.name,
            window.address
        );
    }
    text + "};\n"
}

fn add(text: &mut String, register: &Register) {
    let _ = writeln!(text, "    reg {{\n        desc = \"{}\";", escaped(register.doc));
    if register.fields.is_empty() {
        add_field(text, register, "value", (31, 0), "");
    }
    for field in register.fields {
        add_field(text, register, field.name, (field.low + field.bits - 1, field.low), field.doc);
    }
    let _ = writeln!(text, "    }} {} @ 0x{:x};\n", register.name, register.address);
}

fn add_field(text: &mut String, register: &Register, name: &str, (high, low): (u32, u32), doc: &str) {
    let hardware = if register.access == Access::Status { "w" } else { "r" };
    let bits = (u64::from(register.reset) >> low) & ((1 << (high - low + 1)) - 1);
    let reset =
        if register.access == Access::Control { format!(" reset = 0x{bits:x};") } else { String::new() };
    let doc = if doc.is_empty() { String::new() } else { format!(" desc = \"{}\";", escaped(doc)) };
    let letters = register.access.letters();
    let _ = writeln!(
        text,
        "        field {{ sw = {letters}; hw = {hardware};{reset}{doc} }} {name}[{high}:{low}];"
    );
}

fn escaped(text: &str) -> String {
    text.replace('"', "\\\"")
}
