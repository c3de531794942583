//! How the video chips around the FPGA are set up and polled: a program for each I2C bus, and why each step is there.
//!
//! | what | module |
//! |---|---|
//! | steps, their words, and how a program is put together | [`program`] |
//! | the KC705's own bus: the transmitter | [`transmitter`] |
//! | the FMC-IMAGEON card's bus: the receiver | [`receiver`] |
//! | the ULX3S' bus: a camera | [`ov7670`] |
//! | why a transfer failed | [`cause`] |
//! | EDID of the receiver | [`edid`] |
//!
//! Values are those of the makers' programming guides, of drivers and of public board code; nothing here was tried on a board. What is a
//! guess among them stands in `docs/decisions/0028-video-chips.md`, and in `docs/ulx3s.md` for the camera.

pub mod cause;
pub mod edid;
pub mod ov7670;
pub mod program;
pub mod receiver;
pub mod transmitter;

use crate::video::VideoTiming;
pub use cause::Cause;

pub use program::{Action, Entry, KINDS, SETTINGS, SLOTS, depth, image};

/// Returns the programs of the KC705's buses for a video mode: its own, the card's.
#[must_use]
pub fn programs(mode: VideoTiming) -> [Vec<Entry>; 2] {
    [transmitter::program(), receiver::program(mode)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_step_has_a_meaning_and_every_jump_a_target() {
        for program in
            programs(VideoTiming::P1080_60).into_iter().chain([ov7670::program(ov7670::TIMING, [0, 0])])
        {
            assert!(depth(&program) <= 512 && program.len() < depth(&program));
            for entry in &program {
                assert!(!entry.doc.is_empty());
                assert_eq!(Action::of_word(entry.action.word()), entry.action);
                match entry.action {
                    Action::Goto(target) => assert!(usize::from(target) < program.len()),
                    Action::Wait(milliseconds) => assert!(milliseconds > 0),
                    _ => {}
                }
            }
            assert_eq!(image(&program).lines().count(), depth(&program));
        }
    }

    #[test]
    fn kinds_are_named_as_their_actions() {
        for (kind, name) in (0_u32..).zip(KINDS) {
            let action = format!("{:?}", Action::of_word(kind << 24)).to_lowercase();
            assert!(action.starts_with(&name.replace('_', "")), "{kind}: {name}, {action}");
        }
    }

    /// A step after an `If` or a `More` is skipped or done: it must be a jump, so that what follows is clear.
    #[test]
    fn what_may_be_skipped_is_a_jump() {
        for program in programs(VideoTiming::P1080_60) {
            for pair in program.windows(2) {
                if matches!(pair[0].action, Action::If { .. } | Action::More) {
                    assert!(matches!(pair[1].action, Action::Goto(_)), "{pair:?}");
                }
            }
        }
    }

    /// Every chip that is written is one that the card or the board has.
    #[test]
    fn programs_speak_to_the_chips_of_their_bus_alone() {
        let devices = |program: &[Entry]| -> BTreeSet<u8> {
            program.iter().filter_map(|entry| entry.action.device()).collect()
        };
        let [board, card] = programs(VideoTiming::P1080_60).map(|program| devices(&program));
        assert_eq!(board, [0x39, 0x3f, 0x74].into());
        assert_eq!(card, [0x20, 0x22, 0x32, 0x34, 0x36, 0x4c, 0x70].into());
    }
}
