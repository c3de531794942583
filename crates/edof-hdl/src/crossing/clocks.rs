//! The clock of each port of the leaves between clock domains.

/// Module of a leaf, and the clock port of each port. Ports that are not listed belong to no clock: they may come from any domain.
const CROSSINGS: &[(&str, &[(&str, &str)])] = &[
    ("edof_sync", &[("to_o", "clock_i")]),
    ("edof_reset_sync", &[("reset_o", "clock_i")]),
    (
        "edof_async_fifo",
        &[
            ("write_reset_i", "write_clock_i"),
            ("write_valid_i", "write_clock_i"),
            ("write_ready_o", "write_clock_i"),
            ("write_data_i", "write_clock_i"),
            ("read_reset_i", "read_clock_i"),
            ("read_valid_o", "read_clock_i"),
            ("read_ready_i", "read_clock_i"),
            ("read_data_o", "read_clock_i"),
        ],
    ),
    (
        "edof_pulse_sync",
        &[
            ("from_reset_i", "from_clock_i"),
            ("pulse_i", "from_clock_i"),
            ("ready_o", "from_clock_i"),
            ("to_reset_i", "to_clock_i"),
            ("pulse_o", "to_clock_i"),
        ],
    ),
    (
        "edof_bus_sync",
        &[
            ("from_reset_i", "from_clock_i"),
            ("valid_i", "from_clock_i"),
            ("ready_o", "from_clock_i"),
            ("word_i", "from_clock_i"),
            ("to_reset_i", "to_clock_i"),
            ("valid_o", "to_clock_i"),
            ("word_o", "to_clock_i"),
        ],
    ),
    (
        "edof_serialiser",
        &[("word_i", "word_clock_i"), ("first_o", "bit_clock_i"), ("second_o", "bit_clock_i")],
    ),
];

/// Clock ports by port of a leaf, if it may connect clock domains.
pub(crate) fn of(module: &str) -> Option<&'static [(&'static str, &'static str)]> {
    CROSSINGS.iter().find(|(name, _)| *name == module).map(|(_, ports)| *ports)
}
