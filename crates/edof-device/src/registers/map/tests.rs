use super::*;
use crate::design::memory::ADDRESS_BITS;
use std::collections::BTreeSet;

#[test]
fn nothing_overlaps() {
    let registers = REGISTERS.iter().map(|register| (register.address, register.address + 4));
    let windows = WINDOWS.iter().map(|window| (window.address, window.address + window.bytes));
    let spans: Vec<(u32, u32)> = registers.chain(windows).collect();
    assert!(spans.windows(2).all(|pair| pair[0].1 <= pair[1].0), "{spans:x?}");
    for register in REGISTERS {
        let mut taken = 0;
        for field in register.fields {
            assert!(
                field.low + field.bits <= 32 && taken & field.mask() == 0,
                "{}.{}",
                register.name,
                field.name
            );
            taken |= field.mask();
        }
        assert_eq!(register.reset & !register.mask(), 0, "{}", register.name);
        assert_eq!(register.address % 4, 0);
    }
    assert!(
        WINDOWS.iter().all(|window| window.bytes.is_power_of_two() && window.address % window.bytes == 0)
    );
}

#[test]
fn names_are_unique_and_are_names_everywhere() {
    let is_name = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_lowercase())
            && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    let names: Vec<&str> = REGISTERS.iter().map(|r| r.name).chain(WINDOWS.iter().map(|w| w.name)).collect();
    assert!(names.iter().all(|name| is_name(name)));
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
    assert!(REGISTERS.iter().flat_map(|r| r.fields).all(|field| is_name(field.name)));
}

#[test]
fn bits_of_control_are_where_its_fields_are() {
    let bits = [
        ("run", RUN),
        ("colour", COLOUR),
        ("weight_set", WEIGHT_SET),
        ("i2c_restart", I2C_RESTART),
        ("flush", FLUSH),
    ];
    let masks =
        bits.map(|(name, _)| register("control").and_then(|r| r.field(name)).map(|field| field.mask()));
    assert_eq!(masks, bits.map(|(_, mask)| Some(mask)));
}

#[test]
fn bits_of_protection_are_where_its_fields_are() {
    let bits = [("bank", PROTECT_BANK), ("control", PROTECT_CONTROL), ("other", PROTECT_OTHER)];
    let masks =
        bits.map(|(name, _)| register("protection").and_then(|r| r.field(name)).map(|field| field.mask()));
    assert_eq!(masks, bits.map(|(_, mask)| Some(mask)));
    // What protects must be able to hold what it protects.
    assert!(register("control").is_some_and(|register| register.mask() < 1 << 16));
}

#[test]
fn every_write_of_a_network_has_a_place_in_its_window() {
    assert_eq!(WEIGHTS.word_bits(), ADDRESS_BITS.iter().sum::<u32>());
    assert_eq!(DISPLAY_TABLES.word_bits(), 17);
    assert_eq!([STAGE_COUNTERS, STAGE_READS].map(|window| window.word_bits()), [6; 2]);
}
