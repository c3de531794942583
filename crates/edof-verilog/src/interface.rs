//! What a module is given from outside: its parameters, and where it uses them.

use crate::value::Value;

/// A module's parameters, and what its slots and instances are given.
#[derive(Debug, Default)]
pub(crate) struct Interface {
    pub parameters: Vec<Parameter>,
    /// What stands in each slot.
    pub slots: Vec<Slot>,
    /// Parameters that each instance of a module of ours is given, and their values.
    pub passed: Vec<Vec<(String, String)>>,
}

/// What stands in a slot.
#[derive(Debug, Clone)]
pub(crate) struct Slot {
    pub text: String,
    /// The name of a parameter, rather than a value.
    pub is_parameter: bool,
}

/// A parameter of a module.
#[derive(Debug)]
pub(crate) struct Parameter {
    pub name: String,
    pub comment: String,
    /// The value in the first place where the module stands.
    pub start: Value,
    pub origin: Origin,
}

impl Parameter {
    /// `parameter [3:0] ID = 4'd0`.
    pub fn declaration(&self) -> String {
        format!("parameter {}{} = {}", self.start.of_type, self.name, self.start.text)
    }
}

/// Where a module uses a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    Slot(usize),
    /// A parameter of one of its instances.
    Instance(usize, usize),
}
