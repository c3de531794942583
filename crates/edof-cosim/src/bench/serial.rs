//! The far end of a serial line, as a terminal has it: bytes to levels and back, cycle by cycle.

use std::collections::VecDeque;

/// Start bit, eight bits, stop bit.
const BITS: u32 = 10;

/// A terminal on a serial line: eight bits, the lowest first, no parity, one stop bit.
#[derive(Debug, Clone)]
pub struct Serial {
    cycles_per_bit: u32,
    /// Bytes to send, each with the pause before it, in bits.
    out: VecDeque<(u32, u8)>,
    levels: VecDeque<bool>,
    /// Cycles since the bit that is sent began, and its level.
    sending: (u32, bool),
    /// The byte on its way here: cycles since its start bit, and its bits.
    coming: Option<(u32, u16)>,
    /// Bytes that came and were not taken yet.
    pub came: VecDeque<u8>,
    /// Bytes that came with a wrong start or stop bit.
    pub misshapen: u64,
    /// Cycles since anything was on the line, either way.
    pub quiet: u64,
}

impl Serial {
    /// A sender and receiver for a line with the given cycles per bit.
    #[must_use]
    pub const fn new(cycles_per_bit: u16) -> Self {
        Self {
            cycles_per_bit: cycles_per_bit as u32,
            out: VecDeque::new(),
            levels: VecDeque::new(),
            sending: (0, true),
            coming: None,
            came: VecDeque::new(),
            misshapen: 0,
            quiet: 0,
        }
    }

    /// Sends bytes, each after a pause of that many bits.
    pub fn send(&mut self, bytes: impl IntoIterator<Item = (u32, u8)>) {
        self.out.extend(bytes);
    }

    /// Whether all bytes have left.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.out.is_empty() && self.levels.is_empty()
    }

    /// The level that the terminal gives the line in the next cycle.
    pub fn level(&mut self) -> bool {
        if self.sending.0 == 0 {
            if self.levels.is_empty()
                && let Some((pause, byte)) = self.out.pop_front()
            {
                self.levels.extend((0..pause).map(|_| true).chain([false]));
                self.levels.extend((0..8).map(|bit| byte >> bit & 1 == 1).chain([true]));
            }
            self.quiet = if self.levels.is_empty() { self.quiet } else { 0 };
            self.sending.1 = self.levels.pop_front().unwrap_or(true);
        }
        self.sending.0 = (self.sending.0 + 1) % self.cycles_per_bit;
        self.sending.1
    }

    /// Takes the level of the line to the terminal in a cycle.
    pub fn see(&mut self, level: bool) {
        self.quiet += 1;
        match &mut self.coming {
            None if !level => self.coming = Some((0, 0)),
            None => {}
            Some((cycle, bits)) => {
                self.quiet = 0;
                *cycle += 1;
                // In the middle of each bit.
                if *cycle % self.cycles_per_bit == self.cycles_per_bit / 2 {
                    let bit = *cycle / self.cycles_per_bit;
                    *bits |= u16::from(level) << bit;
                    if bit + 1 == BITS {
                        let is_whole = *bits & 1 == 0 && *bits >> 9 == 1;
                        self.misshapen += u64::from(!is_whole);
                        self.came.extend(is_whole.then_some((*bits >> 1) as u8));
                        self.coming = None;
                    }
                }
            }
        }
    }

    /// Forgets what is on the line, both ways.
    pub fn forget(&mut self) {
        let (cycles_per_bit, misshapen) = (self.cycles_per_bit as u16, self.misshapen);
        *self = Self { misshapen, ..Self::new(cycles_per_bit) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_end_sends_comes_at_the_other() {
        for cycles in [4, 7, 16] {
            let [mut here, mut there] = [Serial::new(cycles), Serial::new(cycles)];
            let bytes: Vec<u8> = (0..=255).collect();
            here.send(bytes.iter().map(|byte| (u32::from(byte % 3), *byte)));
            while !here.is_done() {
                there.see(here.level());
            }
            (0..20 * cycles).for_each(|_| there.see(here.level()));
            assert_eq!((Vec::from(there.came), there.misshapen), (bytes, 0));
        }
    }

    #[test]
    fn a_byte_without_a_stop_bit_is_none() {
        let mut serial = Serial::new(8);
        (0..200).for_each(|_| serial.see(false));
        assert!(serial.came.is_empty() && serial.misshapen > 0);
    }
}
