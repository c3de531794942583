//! The two lines of an I2C bus.

/// Levels of the two lines; `true` is high.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lines {
    /// Clock line.
    pub scl: bool,
    /// Data line.
    pub sda: bool,
}

impl Lines {
    /// Both lines high: nobody talks.
    pub const IDLE: Self = Self { scl: true, sda: true };
}

/// Which lines someone pulls low.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pulls {
    /// Clock line.
    pub scl_low: bool,
    /// Data line.
    pub sda_low: bool,
}
