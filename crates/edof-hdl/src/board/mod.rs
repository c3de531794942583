//! The board around the calculator: frames to and from DRAM, and the host.
//!
//! | block | does |
//! |---|---|
//! | [`write_agent`] | a stream of pixels into one of three frame buffers |
//! | [`read_agent`] | the newest complete frame buffer as a stream of pixels |
//! | [`axi_pair`] | two agents each way on one memory |
//! | [`axi_guard`] | completes what is in flight when they are reset |
//! | [`axi_sdram`] | a controller of an SDRAM |
//! | [`clock_watch`] | whether a clock runs |
//! | [`cycle_count`] | cycles of a clock |
//! | [`registers`] | what the host sees and sets |
//! | [`calculator_port`] | the host's words into the calculator's clock, and back |
//! | [`bank_guard`] | which words belong to a bank that takes none |
//! | [`pattern_source`] | raw frames that the board makes itself |
//! | [`host_frame`] | a raw frame that the host writes, block by block |
//! | [`picture_window`] | a tile of raw pixels that the host writes, and a part of the codes that it reads |
//! | [`power_on`] | the reset after configuration |
//! | [`i2c_master`] | one read or write on an I2C bus |
//! | [`chip_setup`] | sets up the video chips of a bus, and asks them how they are |
//! | [`uart_receiver`], [`uart_sender`] | bytes of a serial line |
//! | [`uart_bus`] | a serial line as a master of registers |
//! | [`embedded_syncs`] | syncs that come inside of the pixels |
//! | [`tables`] | what the display and the set-ups of chips start with |
//! | [`edof_core`] | all of it, for any board |
//! | [`kc705_core`], [`ulx3s_core`] | and what the KC705 and the ULX3S have around it |
//! | [`blocks`] | the blocks of the core, and how long their paths may be |
//!
//! The two agents of a set of buffers tell each other which buffer is whose: the writer says which is the newest complete one, the
//! reader which it reads. The writer takes the one that is neither, so there is always one, and nobody waits for the other.

pub mod axi_guard;
pub mod axi_pair;
pub mod axi_sdram;
pub mod bank_guard;
pub mod blocks;
pub mod calculator_port;
pub mod chip_setup;
pub mod clock_watch;
pub mod cycle_count;
pub mod edof_core;
pub mod embedded_syncs;
pub mod frames;
pub mod host_frame;
pub mod i2c_master;
pub mod kc705_core;
mod pace;
pub mod pattern_source;
pub mod picture_window;
pub mod power_on;
pub mod read_agent;
pub mod registers;
pub mod tables;
pub mod uart_bus;
pub mod uart_receiver;
pub mod uart_sender;
pub mod ulx3s_core;
pub mod write_agent;

pub use axi_guard::AxiGuard;
pub use axi_pair::AxiPair;
pub use axi_sdram::AxiSdram;
pub use bank_guard::BankGuard;
pub use calculator_port::CalculatorPort;
pub use chip_setup::ChipSetup;
pub use clock_watch::ClockWatch;
pub use cycle_count::CycleCount;
pub use edof_core::EdofCore;
pub use embedded_syncs::EmbeddedSyncs;
pub use frames::Frames;
pub use host_frame::HostFrame;
pub use i2c_master::I2cMaster;
pub use kc705_core::Kc705Core;
pub use pace::Pace;
pub use pattern_source::PatternSource;
pub use picture_window::PictureWindow;
pub use power_on::PowerOn;
pub use read_agent::ReadAgent;
pub use registers::{BoardRegisters, Identity};
pub use tables::Tables;
pub use uart_bus::UartBus;
pub use uart_receiver::UartReceiver;
pub use uart_sender::UartSender;
pub use ulx3s_core::Ulx3sCore;
pub use write_agent::WriteAgent;

use rust_hdl::prelude::Bits;

/// One of three frame buffers; 3 is none.
pub type Buffer = Bits<2>;
