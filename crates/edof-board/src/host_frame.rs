//! A whole raw frame onto a board over the line, block by block (docs/host.md).
//!
//! The board takes a block only if its check is right, and shows the check of all that it took. So a put that was interrupted resumes behind
//! the last block that it shares with this frame.

use crate::board::Board;
use crate::contents::frames;
use crate::error::Error;
use crate::line::{Line, line_time};
use crate::link::ATTEMPTS;
use crate::load::Progress;
use crate::protocol::{HEADER, MAX_WORDS};
use edof_device::crc::of_words;
use edof_device::host_frame::{HOST, RESTART, SEND, block_lines, check, words};
use edof_device::registers::map::{CHECK_RAW, FRAME, FRAME_BLOCKS, FRAME_BUSY, PATTERN};
use ndarray::Array2;
use serde::Serialize;
use std::time::Duration;

/// What a put did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Put {
    /// Blocks of the frame.
    pub blocks: usize,
    /// Of these, how many were there before.
    pub resumed: usize,
    /// Words that were sent, those that were sent again too.
    pub words: u64,
    /// Blocks that were sent again.
    pub repeated: u32,
}

/// A raw frame as blocks.
struct Blocks {
    words: Vec<Vec<u32>>,
    /// Check of the frame before each block, and after the last one.
    checks: Vec<u32>,
    crc: u32,
}

/// Looks at a block that is on its way before it is taken for lost.
const MAX_LOOKS: usize = 1_000;
/// Frames after the last block until the calculator must have read this one.
const SETTLE: u32 = 12;
/// Looks for such a frame before it is given up.
const MAX_FRAME_LOOKS: usize = 3_000;
/// Bytes of an answer with two words.
const ANSWER: usize = 8;

impl Blocks {
    fn of(pixels: &Array2<u16>) -> Self {
        let (height, width) = pixels.dim();
        let pixels: Vec<u16> = pixels.iter().copied().collect();
        let blocks = || pixels.chunks(block_lines(width, height) * width);
        let mut checks = vec![0];
        for block in blocks() {
            checks.push(check(checks[checks.len() - 1], block));
        }
        let crc = of_words(pixels.iter().copied());
        Self { words: blocks().map(|block| words(block).collect()).collect(), checks, crc }
    }

    /// Addresses and words of a block that differ from the block that the board has, if that is known.
    fn missing(&self, block: usize, there: Option<usize>) -> Vec<(u32, u32)> {
        let there = there.map(|there| &self.words[there]);
        let words = self.words[block].iter().enumerate();
        words
            .filter(|(index, word)| there.is_none_or(|there| there[*index] != **word))
            .map(|(index, word)| (FRAME.word(index as u32), *word))
            .collect()
    }

    /// Addresses and words of each block from one on, if nothing goes wrong.
    fn ahead(&self, first: usize) -> impl Iterator<Item = Vec<(u32, u32)>> {
        (first..self.words.len()).map(move |block| self.missing(block, (block > first).then(|| block - 1)))
    }
}

/// Returns how long a raw frame is on a line of that speed with all questions and answers, and how many these are: each takes the turn-round of the
/// line's bridge besides.
#[must_use]
pub fn line_time_of(pixels: &Array2<u16>, baud: u32) -> (Duration, usize) {
    let (mut bytes, mut turns) = (0, 0);
    for missing in Blocks::of(pixels).ahead(0) {
        let frames = frames(&missing, MAX_WORDS).len() + 1;
        bytes += 4 * (missing.len() + 1) + frames * (2 * HEADER + ANSWER) + HEADER + ANSWER;
        turns += frames + 1;
    }
    (line_time(bytes, baud), turns)
}

impl<L: Line> Board<L> {
    /// Writes a raw frame of the board's size, which the board then uses in place of its source's, and makes sure that the calculator reads it.
    ///
    /// Blocks that a put of the same frame has left there are not sent again. Words are counted in `progress`.
    ///
    /// # Errors
    /// A frame of another size; a line that fails; [`Error::BlockLost`]; [`Error::FrameDiffers`]; [`Error::NoFrame`] while the calculator is
    /// stopped; [`Error::Interrupted`] when `progress` says so.
    pub fn put_frame(&mut self, pixels: &Array2<u16>, progress: Progress<'_>) -> Result<Put, Error> {
        let expected = (self.identity.width as usize, self.identity.height as usize);
        let found = (pixels.ncols(), pixels.nrows());
        if found != expected {
            return Err(Error::FrameSize { port: self.port(), found, expected });
        }
        let blocks = Blocks::of(pixels);
        let mut next = self.accepted(&blocks)?;
        let mut put = Put { blocks: blocks.words.len(), resumed: next, words: 0, repeated: 0 };
        loop {
            self.send_from(next, &blocks, &mut put, progress)?;
            let crc = self.crc_of_new_frame(blocks.crc)?;
            if crc == blocks.crc {
                return Ok(put);
            }
            // A reset at the last moment.
            next = self.accepted(&blocks)?;
            if next == blocks.words.len() {
                return Err(Error::FrameDiffers { port: self.port(), found: crc, expected: blocks.crc });
            }
        }
    }

    /// Sends the blocks from one on, each until it was accepted.
    fn send_from(
        &mut self,
        mut next: usize,
        blocks: &Blocks,
        put: &mut Put,
        progress: Progress<'_>,
    ) -> Result<(), Error> {
        let total: u64 = blocks.ahead(next).map(|words| words.len() as u64).sum();
        let (mut done, mut tried, mut there) = (0, 0, None);
        while next < blocks.words.len() {
            for (address, some) in frames(&blocks.missing(next, there), MAX_WORDS) {
                if progress(total.min(done), total).is_break() {
                    return Err(Error::Interrupted);
                }
                self.link.write(address, &some)?;
                done += some.len() as u64;
                put.words += some.len() as u64;
            }
            self.link.write(FRAME.word(SEND), &[blocks.checks[next + 1]])?;
            if self.blocks_shown()? == (next + 1, blocks.checks[next + 1]) {
                (there, tried, next) = (Some(next), 0, next + 1);
                continue;
            }
            (there, tried) = (None, tried + 1);
            put.repeated += 1;
            if tried == ATTEMPTS {
                let (block, blocks) = (next, blocks.words.len());
                return Err(Error::BlockLost { port: self.port(), block, blocks, tried });
            }
            next = self.accepted(blocks)?;
        }
        Ok(())
    }

    /// Chooses the host's frame; returns the blocks of this frame that the board has. If it has others the frame is restarted.
    fn accepted(&mut self, blocks: &Blocks) -> Result<usize, Error> {
        if self.link.read(PATTERN, 1)? != [HOST] {
            self.link.set(PATTERN, HOST)?;
        }
        let (accepted, check) = self.agreed("the blocks of the raw frame", Self::blocks_shown)?;
        if blocks.checks.get(accepted) == Some(&check) {
            return Ok(accepted);
        }
        self.link.write(FRAME.word(RESTART), &[0])?;
        Ok(0)
    }

    /// The blocks that were accepted, once none is on its way, and their check.
    fn blocks_shown(&mut self) -> Result<(usize, u32), Error> {
        let mut shown = self.link.glance(FRAME_BLOCKS, 2)?;
        for _ in 0..MAX_LOOKS {
            if shown[0] & FRAME_BUSY == 0 {
                break;
            }
            shown = self.link.glance(FRAME_BLOCKS, 2)?;
        }
        Ok(((shown[0] & 0xffff) as usize, shown[1]))
    }

    /// The CRC of a raw frame that the calculator read: the expected one, or that of a frame that it began after this question.
    fn crc_of_new_frame(&mut self, expected: u32) -> Result<u32, Error> {
        let (mut before, mut passed) = (None, 0);
        for _ in 0..MAX_FRAME_LOOKS {
            self.snapshot()?;
            let words = self.link.read(CHECK_RAW, 5)?;
            let frame = words[4] & 0xff;
            passed += before.map_or(0, |before: u32| frame.wrapping_sub(before) & 0xff);
            before = Some(frame);
            if words[0] == expected || passed > SETTLE {
                return Ok(words[0]);
            }
        }
        Err(Error::NoFrame { port: self.port() })
    }
}
