//! The files of `rtl/` that a circuit can stand on.

/// The hand-written leaves of `rtl/`, by module name.
pub const LEAVES: &[(&str, &str)] = &[
    ("edof_add", include_str!("../../../rtl/edof_add.v")),
    ("edof_add4", include_str!("../../../rtl/edof_add4.v")),
    ("edof_async_fifo", include_str!("../../../rtl/edof_async_fifo.v")),
    ("edof_bus_sync", include_str!("../../../rtl/edof_bus_sync.v")),
    ("edof_delay", include_str!("../../../rtl/edof_delay.v")),
    ("edof_fifo", include_str!("../../../rtl/edof_fifo.v")),
    ("edof_macc", include_str!("../../../rtl/edof_macc.v")),
    ("edof_macc_array", include_str!("../../../rtl/edof_macc_array.v")),
    ("edof_macc_bank", include_str!("../../../rtl/edof_macc_bank.v")),
    ("edof_memory", include_str!("../../../rtl/edof_memory.v")),
    ("edof_power_on", include_str!("../../../rtl/edof_power_on.v")),
    ("edof_pulse_sync", include_str!("../../../rtl/edof_pulse_sync.v")),
    ("edof_queue", include_str!("../../../rtl/edof_queue.v")),
    ("edof_ram", include_str!("../../../rtl/edof_ram.v")),
    ("edof_reset_sync", include_str!("../../../rtl/edof_reset_sync.v")),
    ("edof_scale", include_str!("../../../rtl/edof_scale.v")),
    ("edof_start", include_str!("../../../rtl/edof_start.v")),
    ("edof_sync", include_str!("../../../rtl/edof_sync.v")),
    ("edof_table", include_str!("../../../rtl/edof_table.v")),
];
