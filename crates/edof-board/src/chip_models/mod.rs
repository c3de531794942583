//! The video chips and I2C switches of a KC705 with an FMC-IMAGEON, written from what their makers and well-used drivers say of them.
//!
//! An oracle: nothing here knows how this project sets the chips up. A set-up is right if, through these models, bytes of a source's cable
//! become words at the FPGA's pins, and words at the pins a picture on a screen. Where sources disagree or are silent a model takes the worse.
//!
//! | part | module |
//! |---|---|
//! | two wires, and chips that answer on them | [`wire`] |
//! | what goes wrong on them | [`faults`] |
//! | transfers without a circuit | [`master`] |
//! | switches, pins, bytes behind I2C | [`switch`], [`expander`], [`memory`] |
//! | registers and their rules | [`registers`] |
//! | the receiver: cable to pins | [`adv7611`] |
//! | the transmitter: pins to cable | [`adv7511`] |
//! | links, EDIDs, who is at the ends | [`hdmi`], [`edid`], [`source`], [`graphics_card`], [`screen`] |
//! | an SDRAM, of the ULX3S | [`sdram`] |
//! | a camera at pins: light to bytes | [`ov7670`] |
//! | a screen at a cable without chips: bits of DVI | [`dvi`] |
//! | all of it as it is wired | [`imageon`], [`kc705`] |
//!
//! ```
//! use edof_board::chip_models::{Delays, Imageon, Master, master::Error};
//! let mut card = Imageon::new(Delays::NONE);
//! card.set_reset(true);
//! let mut master = Master::new(&mut card);
//! // The ADV7611 is behind channel 2 of the switch, and in reset until pin 0 of the expander behind channel 3 is high.
//! assert_eq!(master.write(0x4c, &[0x01]), Err(Error::Refused { device: 0x4c, byte: 0 }));
//! master.write(0x70, &[1 << 3])?;
//! master.write(0x20, &[3, 0b1111_1110])?;
//! master.write(0x70, &[1 << 2])?;
//! assert_eq!(master.read(0x4c, &[0xea], 2)?, [0x20, 0x51]);
//! # Ok::<(), Error>(())
//! ```

pub mod adv7511;
pub mod adv7611;
pub mod dvi;
pub mod edid;
pub mod expander;
pub mod faults;
pub mod graphics_card;
pub mod hdmi;
pub mod imageon;
pub mod kc705;
pub mod lines;
pub mod master;
pub mod memory;
pub mod ov7670;
pub mod registers;
pub mod screen;
pub mod sdram;
pub mod source;
pub mod switch;
pub mod wire;

pub use adv7511::{Bus, LowHotPlug};
pub use adv7611::eye::Eye;
pub use faults::{Faults, Hold};
pub use hdmi::Timing;
pub use imageon::{Delays, Imageon};
pub use kc705::Kc705;
pub use master::Master;
pub use ov7670::Ov7670;
pub use screen::Screen;
pub use sdram::Sdram;
pub use source::Source;
pub use wire::{Lines, Pulls, Wires};
