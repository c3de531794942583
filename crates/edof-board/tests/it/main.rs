//! The host's side against the board in Rust, in one program: time is the board's own, so nothing waits.

mod calibrate;
mod camera;
mod check;
mod chips;
mod common;
mod dry_run;
mod faults;
mod host_frame;
mod loading;
mod page;
mod registers;
mod slow;
