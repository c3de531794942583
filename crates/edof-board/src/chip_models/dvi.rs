//! A screen at the end of a DVI cable: from bits on its pairs to pictures and their timing.
//!
//! Source: DVI 1.0, section 3: the channels, the decoder, and symbols of control, by which symbols are found.

use crate::chip_models::hdmi::{Axis, Pixel, Timing};

/// Symbols of control in a row that make a channel found.
const FINDING: usize = 12;
/// The most by which ones and zeros differ after any bytes that the standard's encoder sends, over every state that it reaches.
const BALANCE: i32 = 8;

/// A symbol on all three channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cycle {
    /// Control bits C0 (low) and C1 of channels 0, 1, 2. Those of channel 0 are the horizontal and the vertical sync.
    Control([u8; 3]),
    /// Bytes of channels 0, 1, 2: blue, green, red.
    Pixel(Pixel),
}

/// What a symbol means: control bits, or a byte.
pub fn decoded(symbol: u16) -> Result<u8, u8> {
    match symbol {
        0x354 => Err(0b00),
        0x0ab => Err(0b01),
        0x154 => Err(0b10),
        0x2ab => Err(0b11),
        _ => {
            let bits = if symbol >> 9 & 1 == 1 { !symbol } else { symbol };
            let differs = (bits ^ (bits << 1)) as u8;
            // Bit 0 is sent as it is.
            Ok(if symbol >> 8 & 1 == 1 { differs } else { differs ^ 0xfe })
        }
    }
}

/// What is known of a pair.
#[derive(Debug, Clone, Default)]
struct Pair {
    /// The last ten bits, the first one low.
    window: u16,
    /// Where symbols of control end, of ten places, and how many have come there in a row.
    candidate: usize,
    run: usize,
    /// Where symbols end.
    place: Option<usize>,
    /// By how many ones have exceeded zeros since the last symbol of control.
    disparity: i32,
}

/// A screen's receiver.
#[derive(Debug, Clone, Default)]
pub struct Receiver {
    pairs: [Pair; 4],
    bit: usize,
    /// All since the channels were found.
    pub cycles: Vec<Cycle>,
    /// What no sender may send: channels that do not agree or are not balanced, and a clock that is none.
    pub faults: Vec<String>,
}

impl Receiver {
    /// Takes the next bit of blue, green, red and the clock, ten per pixel. Of the clock ten in a row are five ones and five zeros.
    pub fn bits(&mut self, bits: [bool; 4]) {
        self.bit = (self.bit + 1) % 10;
        for (pair, bit) in self.pairs.iter_mut().zip(bits) {
            pair.window = pair.window >> 1 | u16::from(bit) << 9;
        }
        for pair in &mut self.pairs[..3] {
            if decoded(pair.window).is_err() {
                pair.run = if pair.candidate == self.bit { pair.run + 1 } else { 1 };
                pair.candidate = self.bit;
                if pair.run >= FINDING {
                    pair.place = Some(self.bit);
                }
            } else if pair.candidate == self.bit {
                pair.run = 0;
            }
        }
        let place = self.pairs[0].place;
        let is_found = place.is_some() && self.pairs[..3].iter().all(|pair| pair.place == place);
        if is_found && place == Some(self.bit) {
            self.symbol();
        } else if !is_found && !self.cycles.is_empty() {
            self.faults.push(format!("channels are lost after {} symbols", self.cycles.len()));
            self.cycles.clear();
        }
    }

    fn symbol(&mut self) {
        for pair in &mut self.pairs[..3] {
            let excess = 2 * pair.window.count_ones() as i32 - 10;
            pair.disparity = if decoded(pair.window).is_err() { 0 } else { pair.disparity + excess };
            if pair.disparity.abs() > BALANCE {
                self.faults.push(format!("symbol {}: a disparity of {}", self.cycles.len(), pair.disparity));
            }
        }
        let symbols = [0, 1, 2].map(|i| decoded(self.pairs[i].window));
        let clock = self.pairs[3].window;
        if clock != 0b00_0001_1111 {
            self.faults.push(format!("symbol {}: the clock is {clock:010b}", self.cycles.len()));
        }
        self.cycles.push(match symbols {
            [Ok(blue), Ok(green), Ok(red)] => Cycle::Pixel([blue, green, red]),
            [Err(blue), Err(green), Err(red)] => Cycle::Control([blue, green, red]),
            _ => {
                self.faults.push(format!("symbol {}: channels differ: {symbols:?}", self.cycles.len()));
                Cycle::Control([0; 3])
            }
        });
    }

    /// Returns whole frames in the order in which they came: timing, whether the syncs are negative, pixels line by line.
    ///
    /// # Errors
    /// Lines or syncs that are not all alike, or faults of the channels.
    pub fn frames(&self) -> Result<Vec<Frame>, String> {
        Ok(self.whole()?.0)
    }

    /// Returns them as [`Receiver::frames`] does, and forgets all before the last begin of a frame.
    ///
    /// # Errors
    /// As [`Receiver::frames`].
    pub fn take_frames(&mut self) -> Result<Vec<Frame>, String> {
        let (frames, last) = self.whole()?;
        // The cycle before a sync shows that it begins.
        if !frames.is_empty() {
            self.cycles.drain(..last - 1);
        }
        Ok(frames)
    }

    /// Whole frames, and the cycle at which the last vertical sync begins.
    fn whole(&self) -> Result<(Vec<Frame>, usize), String> {
        if let Some(fault) = self.faults.first() {
            return Err(fault.clone());
        }
        let levels = |which: u8| {
            // While pixels come syncs stay as they were.
            let mut level = 0;
            let each = self.cycles.iter().map(|cycle| {
                if let Cycle::Control([syncs, ..]) = cycle {
                    level = syncs >> which & 1;
                }
                level == 1
            });
            let levels: Vec<bool> = each.collect();
            // A pulse is shorter than what is between two.
            let is_negative = 2 * levels.iter().filter(|level| **level).count() > levels.len();
            (levels.into_iter().map(|level| level != is_negative).collect::<Vec<bool>>(), is_negative)
        };
        let ((hs, hs_negative), (vs, vs_negative)) = (levels(0), levels(1));
        let begins = |pulse: &[bool]| -> Vec<usize> {
            (1..pulse.len()).filter(|at| pulse[*at] && !pulse[at - 1]).collect()
        };
        let (lines, tops) = (begins(&hs), begins(&vs));
        let frame = |[top, next]: [usize; 2]| {
            let lines: Vec<usize> = lines.iter().copied().filter(|at| (top..=next).contains(at)).collect();
            self.frame(&lines, &hs, &vs, [top, next], [hs_negative, vs_negative])
        };
        let frames = tops.windows(2).map(|pair| frame([pair[0], pair[1]])).collect::<Result<_, _>>()?;
        Ok((frames, tops.last().copied().unwrap_or(0)))
    }

    fn frame(
        &self,
        lines: &[usize],
        hs: &[bool],
        vs: &[bool],
        [top, next]: [usize; 2],
        negative: [bool; 2],
    ) -> Result<Frame, String> {
        if lines.first() != Some(&top) || lines.last() != Some(&next) {
            return Err(format!("the vertical sync of symbol {top} does not begin with a line"));
        }
        let one = |what: &str, mut values: Vec<usize>| {
            values.dedup();
            match values[..] {
                [value] => Ok(value),
                _ => Err(format!("{what}: {values:?}")),
            }
        };
        let spans = || lines.windows(2).map(|pair| pair[0]..pair[1]);
        let pixels_of = |span: std::ops::Range<usize>| {
            let is_pixel = |at: &usize| matches!(self.cycles[*at], Cycle::Pixel(_));
            span.filter(is_pixel).collect::<Vec<usize>>()
        };
        let total = one("symbols per line", spans().map(|span| span.len()).collect())?;
        let sync = |pulse: &[bool], span: std::ops::Range<usize>| span.filter(|at| pulse[*at]).count();
        let line_sync = one("horizontal sync", spans().map(|span| sync(hs, span)).collect())?;
        let (seen, active): (Vec<usize>, Vec<Vec<usize>>) =
            spans().map(pixels_of).enumerate().filter(|(_, pixels)| !pixels.is_empty()).unzip();
        let width = one("pixels per line", active.iter().map(Vec::len).collect())?;
        let starts = seen.iter().zip(&active).map(|(row, pixels)| pixels[0] - lines[*row]).collect();
        let start = one("first pixel of a line", starts)?;
        if active.iter().any(|pixels| pixels[width - 1] - pixels[0] + 1 != width)
            || seen[seen.len() - 1] - seen[0] + 1 != seen.len()
        {
            return Err("pixels have gaps".into());
        }
        let vertical = sync(vs, top..next);
        if !vertical.is_multiple_of(total) {
            return Err(format!("a vertical sync of {vertical} symbols, of lines of {total}"));
        }
        let (rows, sync_lines) = (lines.len() - 1, vertical / total);
        let axis = |total: usize, sync: usize, start: usize, active: usize| Axis {
            active,
            sync,
            back: start - sync,
            front: total - start - active,
        };
        let timing = Timing {
            line: axis(total, line_sync, start, width),
            frame: axis(rows, sync_lines, seen[0], seen.len()),
            khz: 0,
        };
        let rgb = |at: usize| match self.cycles[at] {
            Cycle::Pixel([blue, green, red]) => [red, green, blue],
            Cycle::Control(_) => [0; 3],
        };
        Ok(Frame { timing, negative, pixels: active.into_iter().flatten().map(rgb).collect() })
    }
}

/// A whole frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Its timing, without the clock.
    pub timing: Timing,
    /// Whether the horizontal and the vertical sync are negative pulses.
    pub negative: [bool; 2],
    /// Red, green and blue, line by line.
    pub pixels: Vec<Pixel>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes and symbols, bit 9 first: what the decoder's page says for both choices of bits 8 and 9, by hand.
    #[test]
    fn bytes_are_read_as_the_standard_says() {
        for (symbol, byte) in [
            (0b01_0000_0000, 0x00),
            (0b11_1111_1111, 0x00),
            (0b10_0000_0000, 0xff),
            (0b00_1111_1111, 0xff),
            (0b01_1111_1111, 0x01),
            (0b01_1111_0000, 0x10),
            (0b10_1000_0000, 0x7f),
        ] {
            assert_eq!(decoded(symbol), Ok(byte), "{symbol:010b}");
        }
    }
}
