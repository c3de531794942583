//! The chips as their makers describe them. Set-ups here are the fact sheets' own, step by step.

mod bus;
mod first_light;
mod first_tables;
mod receiver;
mod setup;
mod transmitter;
