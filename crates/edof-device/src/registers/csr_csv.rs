//! The map as LiteX's clients read it (`csr.csv`).

use super::map::{REGISTERS, WINDOWS};
use std::fmt::Write;

/// The file: each register with its byte address, its length in words and whether it can be written, each window as a region of memory.
#[must_use]
pub fn csr_csv() -> String {
    let mut text = String::from("csr_base,edof,0x00000000,,\n");
    // Writing to a String cannot fail.
    for register in REGISTERS {
        let mode = if register.access.letters() == "rw" { "rw" } else { "ro" };
        let _ = writeln!(text, "csr_register,edof_{},0x{:08x},1,{mode}", register.name, register.address);
    }
    text += "constant,config_csr_data_width,32,,\nconstant,config_bus_address_width,32,,\n";
    for window in WINDOWS {
        let _ = writeln!(text, "memory_region,{},0x{:08x},{},io", window.name, window.address, window.bytes);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_has_five_fields_and_every_register_and_window_one_line() {
        let text = csr_csv();
        assert!(text.lines().all(|line| line.split(',').count() == 5), "{text}");
        let count = |kind: &str| text.lines().filter(|line| line.starts_with(kind)).count();
        assert_eq!([count("csr_register,"), count("memory_region,")], [REGISTERS.len(), WINDOWS.len()]);
        assert!(text.contains("csr_register,edof_control,0x00000014,1,rw\n"), "{text}");
        assert!(text.contains("csr_register,edof_status,0x00000020,1,ro\n"), "{text}");
    }
}
