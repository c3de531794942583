//! Pages of registers, and what a write to them may be.

use std::ops::RangeInclusive;

/// What a register takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Any value, which is read back.
    Plain,
    /// One of these values; another one is a complaint.
    Fixed(&'static [u8]),
    /// Status: writes change nothing.
    ReadOnly,
    /// Bits that act when written and read as 0.
    Strobe,
}

/// Registers, their default and their rule.
pub type Entry = (RangeInclusive<u8>, u8, Rule);

/// 256 registers.
#[derive(Debug, Clone)]
pub struct Page {
    name: &'static str,
    values: [u8; 256],
    defaults: [u8; 256],
    rules: [Option<Rule>; 256],
    complaints: Vec<String>,
}

impl Page {
    /// Registers of these entries; a register without an entry is not documented, and a write to it is a complaint.
    #[must_use]
    pub fn new(name: &'static str, entries: &[Entry]) -> Self {
        let (mut defaults, mut rules) = ([0; 256], [None; 256]);
        for (registers, default, rule) in entries {
            for register in registers.clone() {
                defaults[usize::from(register)] = *default;
                rules[usize::from(register)] = Some(*rule);
            }
        }
        Self { name, values: defaults, defaults, rules, complaints: vec![] }
    }

    /// Registers that all take any value except for these entries.
    #[must_use]
    pub fn documented(name: &'static str, defaults: [u8; 256], entries: &[Entry]) -> Self {
        let mut page = Self::new(name, entries);
        page.rules = page.rules.map(|rule| rule.or(Some(Rule::Plain)));
        (page.values, page.defaults) = (defaults, defaults);
        page
    }

    /// The value of a register.
    #[must_use]
    pub const fn get(&self, register: u8) -> u8 {
        self.values[register as usize]
    }

    /// Bits `high` to `low` of a register.
    #[must_use]
    pub const fn bits(&self, register: u8, high: u8, low: u8) -> u8 {
        (self.get(register) >> low) & (0xff >> (7 - (high - low)))
    }

    /// A bit of a register.
    #[must_use]
    pub const fn bit(&self, register: u8, bit: u8) -> bool {
        self.bits(register, bit, bit) == 1
    }

    /// Writes a register by its rule; returns whether the chip takes the value.
    pub fn write(&mut self, register: u8, value: u8) -> bool {
        let rule = self.rules[usize::from(register)];
        let name = self.name;
        match rule {
            Some(Rule::Plain | Rule::Strobe) => {}
            Some(Rule::Fixed(values)) if values.contains(&value) => {}
            Some(Rule::Fixed(values)) => self.complain(format!(
                "{name} {register:02X} = {value:02X}: reserved, to be {}",
                values.iter().map(|value| format!("{value:02X}")).collect::<Vec<_>>().join(" or ")
            )),
            Some(Rule::ReadOnly) => self.complain(format!("{name} {register:02X} = {value:02X}: read only")),
            None => self.complain(format!("{name} {register:02X} = {value:02X}: no register of this chip")),
        }
        let takes = !matches!(rule, Some(Rule::ReadOnly | Rule::Strobe));
        if takes {
            self.values[usize::from(register)] = value;
        }
        takes
    }

    /// Gives a register a value from inside.
    pub const fn set(&mut self, register: u8, value: u8) {
        self.values[register as usize] = value;
    }

    /// Registers fall to their defaults, except for those of a range.
    pub fn reset(&mut self, keeps: impl Fn(u8) -> bool) {
        for register in (0..=255).filter(|register| !keeps(*register)) {
            self.values[usize::from(register)] = self.defaults[usize::from(register)];
        }
    }

    /// Whether a register has its default.
    #[must_use]
    pub const fn is_default(&self, register: u8) -> bool {
        self.values[register as usize] == self.defaults[register as usize]
    }

    /// What was written against the rules.
    #[must_use]
    pub fn complaints(&self) -> &[String] {
        &self.complaints
    }

    fn complain(&mut self, complaint: String) {
        if !self.complaints.contains(&complaint) {
            self.complaints.push(complaint);
        }
    }
}
