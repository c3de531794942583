//! The leaves that may stand between clock domains.

/// A leaf that may stand between clock domains, and the clock to which each of its ports belongs.
pub(crate) struct Marked {
    module: &'static str,
    ports: &'static [(&'static str, &'static str)],
}

/// Ports that are not named belong to no clock: they may come from anywhere.
const MARKED: &[Marked] = &[
    Marked { module: "edof_sync", ports: &[("to_o", "clock_i")] },
    Marked { module: "edof_reset_sync", ports: &[("reset_o", "clock_i")] },
    Marked {
        module: "edof_async_fifo",
        ports: &[
            ("write_reset_i", "write_clock_i"),
            ("write_valid_i", "write_clock_i"),
            ("write_ready_o", "write_clock_i"),
            ("write_data_i", "write_clock_i"),
            ("read_reset_i", "read_clock_i"),
            ("read_valid_o", "read_clock_i"),
            ("read_ready_i", "read_clock_i"),
            ("read_data_o", "read_clock_i"),
        ],
    },
    Marked {
        module: "edof_pulse_sync",
        ports: &[
            ("from_reset_i", "from_clock_i"),
            ("pulse_i", "from_clock_i"),
            ("ready_o", "from_clock_i"),
            ("to_reset_i", "to_clock_i"),
            ("pulse_o", "to_clock_i"),
        ],
    },
    Marked {
        module: "edof_bus_sync",
        ports: &[
            ("from_reset_i", "from_clock_i"),
            ("valid_i", "from_clock_i"),
            ("ready_o", "from_clock_i"),
            ("word_i", "from_clock_i"),
            ("to_reset_i", "to_clock_i"),
            ("valid_o", "to_clock_i"),
            ("word_o", "to_clock_i"),
        ],
    },
];

impl Marked {
    /// The clock of a port.
    pub(crate) fn clock_of(&self, port: &str) -> Option<&'static str> {
        self.ports.iter().find(|(name, _)| *name == port).map(|(_, clock)| *clock)
    }
}

/// The leaf of that name, if it may stand between clock domains.
pub(crate) fn marked(module: &str) -> Option<&'static Marked> {
    MARKED.iter().find(|marked| marked.module == module)
}
