//! The host's frame: what leaves are whole frames of the source from their first pixel on, or blocks whose check was right, in order, however everyone
//! pauses.

use crate::board_blocks::{model, source};
use edof_board::simulated::host_frame::HostFrame as Expected;
use edof_core::Stride;
use edof_core::draw::Draw;
use edof_cosim::Source;
use edof_cosim::bench::{Beat, Bench, Receiver, Sender, Throttle};
use edof_device::design::FrameSize;
use edof_device::host_frame::{RESTART, SEND, check};
use edof_hdl::board::HostFrame;

/// Four blocks of 23 lines.
const FRAME: FrameSize = FrameSize { width: 90, height: 92, stride: Stride::PATCH };
const BLOCK: usize = 23 * 90;
/// Longer than anyone pauses.
const SETTLE: usize = 1_500;

struct Rig {
    bench: Bench,
    sender: Sender,
    receiver: Receiver,
    host: Expected,
    /// Beats of blocks that must have left.
    expected: Vec<Beat>,
    /// Words of the block that were written.
    words: Vec<u32>,
}

impl Rig {
    fn new(source: &Source, seed: u64) -> Self {
        let mut bench = Bench::new(model(source, seed), seed);
        let clock = bench.clock("clock_i", 10_000).unwrap();
        let sender = Sender::new(source, "source", clock, "reset_i", Throttle::drawn(seed + 10)).unwrap();
        let receiver = Receiver::new(source, "pixels", clock, "reset_i", Throttle::drawn(seed + 20)).unwrap();
        for (port, level) in [("reset_i", 1), ("select_i", 0), ("write_i", 0)] {
            bench.set(port, level).unwrap();
        }
        let (host, words) = (Expected::new(FRAME), vec![0; BLOCK / 2]);
        let mut rig = Self { bench, sender, receiver, host, expected: vec![], words };
        rig.steps(4);
        rig.bench.set("reset_i", 0).unwrap();
        rig
    }

    fn steps(&mut self, count: usize) {
        for _ in 0..count {
            // Frames of five lines of seven pixels, each with the number of its place, without an end.
            if self.sender.beats.len() < 2 {
                let first = self.sender.sent + self.sender.beats.len();
                let number = |i: usize| (first + i) % 0x1_0000;
                let beat = |i: usize| Beat {
                    data: number(i) as u64,
                    user: (first + i).is_multiple_of(35),
                    last: (first + i) % 7 == 6,
                };
                self.sender.beats.extend((0..35).map(beat));
            }
            self.bench.step(&mut [&mut self.sender, &mut self.receiver]).unwrap();
        }
    }

    fn write(&mut self, index: u32, word: u32) {
        for (port, value) in [("write_i", 1), ("address_i", index.into()), ("data_i", word.into())] {
            self.bench.set(port, value).unwrap();
        }
        self.steps(1);
        self.bench.set("write_i", 0).unwrap();
    }

    fn shown(&mut self) -> [u64; 2] {
        ["blocks_o", "check_o"].map(|port| self.bench.get(port).unwrap())
    }

    /// Writes a word that is taken, and notes what must leave.
    fn write_taken(&mut self, index: u32, word: u32) {
        self.write(index, word);
        let first = self.host.pixels().len();
        let beat = |(i, pixel): (usize, &u16)| Beat {
            data: u64::from(*pixel),
            user: first + i == 0,
            last: (first + i) % FRAME.width == FRAME.width - 1,
        };
        self.expected.extend(self.host.write(index, word).iter().enumerate().map(beat));
    }

    /// Writes some words of the block in any order, and sends it with the right check or another. Whether the block must leave.
    fn block(&mut self, draw: &mut Draw) -> bool {
        for _ in 0..draw.whole(0, 40) {
            let (index, word) = (draw.whole(0, BLOCK as i64 / 2 - 1) as usize, draw.bits() as u32);
            self.words[index] = word;
            self.write_taken(index as u32, word);
            let pause = draw.whole(0, 3) as usize;
            self.steps(pause);
        }
        let pixels: Vec<u16> =
            self.words.iter().flat_map(|word| [*word as u16, (*word >> 16) as u16]).collect();
        let wrong = if draw.whole(0, 3) == 0 { 1 << draw.whole(0, 31) } else { 0 };
        let before = self.host.blocks();
        self.write_taken(SEND, check(self.host.check(), &pixels) ^ wrong);
        self.host.blocks() > before
    }

    fn wait(&mut self, what: &str, is_so: impl Fn(&mut Self) -> bool) {
        for _ in 0..400_000 {
            if is_so(self) {
                return;
            }
            self.steps(1);
        }
        panic!("{what} never comes");
    }

    /// Takes beats of blocks that came: all that were expected, and no other ones.
    fn blocks_came(&mut self) {
        self.wait("the end of a block", |rig| {
            rig.shown()[0] >> 16 == 0 && rig.receiver.beats.len() >= rig.expected.len()
        });
        assert_eq!(self.receiver.beats.split_off(0), std::mem::take(&mut self.expected));
        assert_eq!(self.shown(), [self.host.blocks(), self.host.check()].map(u64::from));
    }
}

/// Beats of the source: one after the other.
#[track_caller]
fn is_of_the_source(beats: &[Beat]) {
    for pair in beats.windows(2) {
        assert_eq!(pair[1].data, (pair[0].data + 1) % 0x1_0000);
    }
}

#[test]
fn only_blocks_with_a_right_check_leave_and_the_sources_frames_begin_at_their_first_pixel() {
    let source = source(HostFrame::new(FRAME));
    let (mut whole, mut rejected, mut cut) = (0, 0, 0);
    for seed in 0..4 {
        let draw = &mut Draw::new(seed);
        let mut rig = Rig::new(&source, seed);
        rig.steps(SETTLE);
        assert!(rig.receiver.beats[0].user);
        for _ in 0..3 {
            rig.bench.set("select_i", 1).unwrap();
            rig.steps(SETTLE);
            is_of_the_source(&rig.receiver.beats.split_off(0));
            for index in 0..BLOCK as u32 / 2 {
                rig.words[index as usize] = draw.bits() as u32;
                rig.write_taken(index, rig.words[index as usize]);
            }
            for _ in 0..draw.whole(1, 9) {
                if rig.block(draw) {
                    // What the host writes meanwhile is ignored, a restart too.
                    let at = draw.whole(1, 2_000) as usize;
                    rig.steps(at);
                    for index in [0, SEND, RESTART] {
                        rig.write(index, draw.bits() as u32);
                    }
                } else {
                    rejected += 1;
                }
                rig.blocks_came();
                whole += u32::from(rig.host.is_whole());
                if draw.whole(0, 7) == 0 {
                    rig.write_taken(RESTART, draw.bits() as u32);
                    rig.blocks_came();
                }
            }
            // Back to the source, perhaps while a block leaves.
            if draw.whole(0, 1) == 0 && rig.block(draw) {
                rig.steps(draw.whole(1, 6_000) as usize);
                cut += 1;
            }
            rig.bench.set("select_i", 0).unwrap();
            rig.wait("the source", |rig| {
                rig.shown() == [0, 0] && rig.receiver.beats.len() > rig.expected.len()
            });
            rig.steps(SETTLE);
            let mut beats = rig.receiver.beats.split_off(0);
            let of_source = beats.split_off(rig.expected.len());
            assert_eq!(beats, std::mem::take(&mut rig.expected));
            assert!(of_source.len() > 10 && of_source[0].user, "{:?}", of_source.first());
            is_of_the_source(&of_source);
            rig.host.restart();
            // Without the choice words are ignored.
            rig.write(0, draw.bits() as u32);
        }
    }
    assert!(whole > 0 && rejected > 4 && cut > 0, "{whole} whole frames, {rejected} rejected, {cut} cut");
}
