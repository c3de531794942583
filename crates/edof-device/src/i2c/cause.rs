//! Why a transfer on an I2C bus, or a set-up, failed.

/// A cause; its number is that of the registers `i2c_board`, `i2c_card` and `chip_answer`, where 0 is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Cause {
    /// A byte was not acknowledged.
    Refused = 1,
    /// The data line was low while the master let it rise.
    Arbitration = 2,
    /// The data line stays low.
    DataLow = 3,
    /// The clock line was held low for too long.
    ClockLow = 4,
    /// A register has another value than it must have.
    OtherValue = 5,
}

impl Cause {
    /// The cause of a number; none for 0 and for numbers that mean nothing.
    #[must_use]
    pub fn of_number(number: u32) -> Option<Self> {
        [Self::Refused, Self::Arbitration, Self::DataLow, Self::ClockLow, Self::OtherValue]
            .into_iter()
            .find(|cause| *cause as u32 == number)
    }
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Refused => "does not acknowledge",
            Self::Arbitration => "lost the bus to someone else",
            Self::DataLow => "data line held low",
            Self::ClockLow => "clock line held low",
            Self::OtherValue => "reads back another value",
        })
    }
}
