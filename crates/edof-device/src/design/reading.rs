//! Reading a stage's memories back: the host writes a command, the stage reads rows and makes a CRC of them (docs/calculator.md).

use super::memory::{Space, row_bits, weight_words};
use super::timing::{READ_LATENCY, READ_PERIOD, STEAL_LATENCY};
use super::{Design, StagePlan};
use edof_network::fixed_network::FixedNetwork;
use std::collections::BTreeSet;

/// Register of a stage that a command to read is written to.
pub const READ_REGISTER: usize = 3;

/// Register of a stage that shows the CRC-32 of what it sent of the last whole frame ([`crate::crc`]), as of the last snapshot of its counters.
pub const CHECK_REGISTER: usize = 4;
/// Register of a stage that shows which frame that was, modulo 256.
pub const CHECK_FRAME_REGISTER: usize = 5;

/// What a stage shows of what it read: see [`read_back_address`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadBack {
    /// [`crc`] of all rows of the command.
    Crc,
    /// The low half of the row that was read last.
    Low,
    /// High half of the row.
    High,
    /// 1 while the stage still reads, then 0.
    Busy,
}

/// Bit of an address of what a stage shows that asks for what it read, and not for a counter.
pub const READ_BACK: u32 = 1 << 6;

/// Where a stage shows what it read: [`READ_BACK`], the stage (4 bits), which part (2 bits).
#[must_use]
pub const fn read_back_address(stage: usize, part: ReadBack) -> u32 {
    READ_BACK | (stage as u32) << 2 | part as u32
}

/// The word that, written to [`READ_REGISTER`] of a stage, has `rows` of its rows read (1 to 4096), from that of `from` on. Of weights both
/// halves are read at once. A command while another is carried out takes its place.
#[must_use]
pub const fn read_command(from: Space, rows: usize) -> u32 {
    let (code, bank, row) = match from {
        Space::Weights { bank, row, .. } => (0, bank, row),
        Space::Thresholds { row } => (1, 0, row),
        Space::PreviousThresholds { row } => (2, 0, row),
        Space::Register { row } => (3, 0, row),
    };
    ((code << 30) | (bank << 24) | (row << 12) | (rows - 1)) as u32
}

/// The rows that a [`read_command`] has read.
#[must_use]
pub const fn rows_of(command: u32) -> usize {
    (command & 0xfff) as usize + 1
}

/// CRC-32 (IEEE 802.3) of rows of 64 bits, the lowest bit of the first one first.
///
/// ```
/// use edof_device::design::reading::crc;
/// // The check value that every description of this CRC gives is that of "123456789"; here with seven bytes of zeros behind it.
/// let rows = [u64::from_le_bytes(*b"12345678"), u64::from(b'9')];
/// assert_eq!(crc(rows), of_bytes(b"123456789\0\0\0\0\0\0\0"));
/// assert_eq!(of_bytes(b"123456789"), 0xcbf4_3926);
///
/// fn of_bytes(bytes: &[u8]) -> u32 {
///     let step = |crc: u32| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
///     !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
/// }
/// ```
pub fn crc(rows: impl IntoIterator<Item = u64>) -> u32 {
    let mut crc = !0u32;
    for mut row in rows {
        let mut bits = 64;
        while bits > 0 {
            let is_odd = (crc ^ row as u32) & 1;
            crc = (crc >> 1) ^ (0xedb8_8320 & is_odd.wrapping_neg());
            (row, bits) = (row >> 1, bits - 1);
        }
    }
    !crc
}

/// All rows of a bank that hold one set, in the order of their numbers: of a number that stands for no word, 0 is read.
#[must_use]
pub fn bank_rows(network: &FixedNetwork, stage: &StagePlan, bank: usize) -> Vec<u64> {
    let parts: Vec<Vec<u64>> =
        (0..stage.row_words()).map(|part| weight_words(network, stage, bank, part)).collect();
    let numbers =
        (0..stage.weight_rows()).flat_map(|row| (0..1 << row_bits(stage)).map(move |part| (row, part)));
    numbers.map(|(row, part)| parts.get(part).map_or(0, |words: &Vec<u64>| words[row])).collect()
}

/// Rows of a table of the display, as the number [`super::memory::TABLES`] in place of a stage's gives them: four entries a row, the lowest
/// in the lowest 16 bits.
#[must_use]
pub fn table_rows(entries: &[u16]) -> Vec<u64> {
    let row = |four: &[u16]| four.iter().rev().fold(0, |row, entry| row << 16 | u64::from(*entry));
    entries.chunks(TABLE_ENTRIES).map(row).collect()
}

/// Entries of a row of a table.
pub const TABLE_ENTRIES: usize = 4;
/// Rows of a bank of tables.
pub const TABLE_ROWS: usize = 4096;

/// The bank at which table 0 (luma), 1, 2 or 3 (red, green, blue) begins; luma has the one after it, too.
#[must_use]
pub const fn table_bank(table: usize) -> usize {
    2 * table
}

/// Cycles in which stage `stage` makes no step for writes (cycle in order, address, word): a weight that it must write where both ports
/// of its memory read, and a row of weights that it reads back. The latter goes in the first cycle, from when it is due on, that no write
/// wants, whatever it writes.
#[must_use]
pub fn stolen(design: &Design, stage: usize, writes: &[(u64, u32, u32)]) -> BTreeSet<u64> {
    let (place, space, row) = (
        |address: u32| (address >> 21) as usize,
        |address: u32| (address >> 19) & 3,
        |address: u32| (address >> 1 & 0xfff) as usize,
    );
    let mine = || writes.iter().filter(|(_, address, _)| place(*address) == stage);
    let wanted: BTreeSet<u64> = writes.iter().map(|(cycle, ..)| cycle + STEAL_LATENCY).collect();
    let both_ports = design.stage(stage).reads_both_ports();
    let weights = mine().filter(|(_, address, _)| both_ports && space(*address) == 0);
    let mut stolen: BTreeSet<u64> = weights.map(|(cycle, ..)| cycle + STEAL_LATENCY).collect();
    let commands: Vec<(u64, u32)> = mine()
        .filter(|(_, address, _)| space(*address) == 3 && row(*address) == READ_REGISTER)
        .map(|(cycle, _, command)| (*cycle, *command))
        .collect();
    for (index, (cycle, command)) in
        commands.iter().enumerate().filter(|(_, (_, command))| command >> 30 == 0)
    {
        let end = commands.get(index + 1).map_or(u64::MAX, |(next, _)| next + STEAL_LATENCY + 1);
        let mut due = cycle + READ_LATENCY;
        for _ in 0..=(command & 0xfff) {
            while wanted.contains(&due) {
                due += 1;
            }
            if due > end {
                break;
            }
            stolen.insert(due);
            due += READ_PERIOD;
        }
    }
    stolen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::memory::address;

    /// The design `tiny`: both ports of its last stage read.
    fn tiny() -> Design {
        Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap()
    }

    fn weights(row: usize) -> Space {
        Space::Weights { bank: 0, row, half: 0 }
    }

    fn command(stage: usize, rows: usize) -> (u32, u32) {
        (address(stage, Space::Register { row: READ_REGISTER }), read_command(weights(3), rows))
    }

    #[test]
    fn a_row_that_is_read_takes_a_step_every_256_cycles() {
        let (to, word) = command(0, 3);
        assert_eq!(stolen(&tiny(), 0, &[(100, to, word)]), [168, 424, 680].into());
        assert_eq!(stolen(&tiny(), 1, &[(100, to, word)]), [].into());
    }

    #[test]
    fn a_write_goes_first_whatever_it_writes() {
        let (to, word) = command(3, 2);
        let write = |cycle| (cycle, address(3, weights(0)), 0);
        let other = |cycle| (cycle, address(0, weights(0)), 0);
        // Cycles 168 and 169 are wanted by writes, one of them another stage's, so that the second row is due in 426.
        let writes = [(100, to, word), write(166), other(167)];
        assert_eq!(stolen(&tiny(), 3, &writes), [168, 170, 426].into());
    }

    #[test]
    fn a_command_takes_the_place_of_the_one_before() {
        let (to, word) = command(0, 9);
        assert_eq!(stolen(&tiny(), 0, &[(100, to, word), (421, to, word & !0xfff)]), [168, 424, 489].into());
        assert_eq!(stolen(&tiny(), 0, &[(100, to, word), (420, to, word & !0xfff)]), [168, 488].into());
        let of_registers = read_command(Space::Register { row: 0 }, 1);
        assert_eq!(stolen(&tiny(), 0, &[(100, to, word), (420, to, of_registers)]), [168].into());
    }

    #[test]
    fn a_wrong_bit_gives_another_crc() {
        for bit in 0..64 {
            assert_ne!(crc([1, 2, 3]), crc([1, 2 ^ (1 << bit), 3]));
        }
    }
}
