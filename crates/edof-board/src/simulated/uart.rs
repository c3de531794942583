//! The board's end of the line, byte by byte: what `uart_bus` of the circuit does.

use crate::protocol::{READ_FIXED, WRITE, WRITE_FIXED};

/// The registers behind it.
pub trait Bus {
    /// Writes a word to a byte address; what cannot be written is passed over.
    fn write(&mut self, address: u32, word: u32);
    /// The word at a byte address; 0 without one.
    fn read(&mut self, address: u32) -> u32;
}

/// Where a frame stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Phase {
    #[default]
    Command,
    Length,
    Address,
    Data,
}

/// Frames out of bytes.
#[derive(Debug, Clone, Default)]
pub struct Uart {
    phase: Phase,
    command: u8,
    left: u8,
    address: u32,
    word: u32,
    bytes: u8,
    /// Frames that were given up, and bytes that were no command.
    pub broken: u32,
}

impl Uart {
    /// Takes a byte; gives the words that answer it, as bytes.
    pub fn byte(&mut self, byte: u8, bus: &mut impl Bus) -> Vec<u8> {
        match self.phase {
            Phase::Command => {
                if (WRITE..=READ_FIXED).contains(&byte) {
                    (self.command, self.phase) = (byte, Phase::Length);
                } else {
                    self.broken = self.broken.wrapping_add(1);
                }
            }
            Phase::Length => (self.left, self.bytes, self.phase) = (byte, 0, Phase::Address),
            Phase::Address => {
                self.address = self.address << 8 | u32::from(byte);
                self.bytes += 1;
                if self.bytes == 4 {
                    return self.addressed(bus);
                }
            }
            Phase::Data => {
                self.word = self.word << 8 | u32::from(byte);
                self.bytes += 1;
                if self.bytes == 4 {
                    bus.write(self.address << 2, self.word);
                    self.next();
                }
            }
        }
        vec![]
    }

    fn addressed(&mut self, bus: &mut impl Bus) -> Vec<u8> {
        self.bytes = 0;
        self.phase = if self.left == 0 { Phase::Command } else { Phase::Data };
        if self.left == 0 || self.command == WRITE || self.command == WRITE_FIXED {
            return vec![];
        }
        let mut answer = vec![];
        while self.phase == Phase::Data {
            answer.extend(bus.read(self.address << 2).to_be_bytes());
            self.next();
        }
        answer
    }

    /// To the next word, or the end of the frame.
    fn next(&mut self) {
        (self.left, self.bytes) = (self.left - 1, 0);
        if self.command < WRITE_FIXED {
            self.address = self.address.wrapping_add(1);
        }
        if self.left == 0 {
            self.phase = Phase::Command;
        }
    }

    /// Whether the UART waits for the rest of a frame.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.phase != Phase::Command
    }

    /// Gives up a frame whose rest does not come.
    pub fn time_out(&mut self) {
        if self.waits() {
            self.phase = Phase::Command;
            self.broken = self.broken.wrapping_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol;

    #[derive(Default)]
    struct Told(Vec<(u32, u32)>);

    impl Bus for Told {
        fn write(&mut self, address: u32, word: u32) {
            self.0.push((address, word));
        }

        fn read(&mut self, address: u32) -> u32 {
            address + 1
        }
    }

    fn sent(uart: &mut Uart, bytes: &[u8]) -> (Vec<u8>, Vec<(u32, u32)>) {
        let mut told = Told::default();
        let answers = bytes.iter().flat_map(|byte| uart.byte(*byte, &mut told)).collect();
        (answers, told.0)
    }

    #[test]
    fn frames_are_answered_as_uartbone_says() {
        let uart = &mut Uart::default();
        assert_eq!(sent(uart, &protocol::write(8, &[5, 6])), (vec![], vec![(8, 5), (12, 6)]));
        assert_eq!(sent(uart, &[3, 2, 0, 0, 0, 2, 0, 0, 0, 5, 0, 0, 0, 6]).1, [(8, 5), (8, 6)]);
        assert_eq!(sent(uart, &protocol::read(8, 2)).0, [0, 0, 0, 9, 0, 0, 0, 13]);
        assert_eq!(sent(uart, &[4, 2, 0, 0, 0, 2]).0, [0, 0, 0, 9, 0, 0, 0, 9]);
        assert_eq!((sent(uart, &[2, 0, 0, 0, 0, 2]).0, uart.broken), (vec![], 0));
    }

    #[test]
    fn what_is_no_frame_is_counted() {
        let uart = &mut Uart::default();
        sent(uart, &[0, 5, 0xff]);
        assert_eq!(uart.broken, 3);
        for cut in 1..10 {
            sent(uart, &protocol::write(8, &[5])[..cut]);
            uart.time_out();
            assert_eq!((uart.broken, sent(uart, &protocol::read(8, 1)).0.len()), (3 + cut as u32, 4));
        }
    }
}
