//! The `edof` command.
fn main() {}
