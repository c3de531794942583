//! What a board answers: a line on which everything but the board's name is as the input says.

use edof_board::board::Board;
use edof_board::diagnosis::findings;
use edof_board::line::Line;
use edof_board::protocol::{HEADER, READ, WRITE};
use edof_board::status::report;
use edof_device::board::KC705;
use edof_device::registers::map;
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::time::Duration;

/// A board whose registers hold the input's words.
struct Replies<'a> {
    words: &'a [u8],
    /// How many of the first answers are whole.
    whole: u8,
    /// What is done to the others: cut, doubled, changed.
    fault: u8,
    answers: u8,
    written: BTreeMap<u32, u32>,
    leaving: VecDeque<u8>,
    time: Duration,
}

impl Replies<'_> {
    fn word(&self, address: u32) -> u32 {
        match (address, self.written.get(&address)) {
            (_, Some(word)) => *word,
            (0, _) => map::ID,
            (4, _) => map::VERSION,
            _ => {
                let at = |byte: usize| {
                    self.words.get((address as usize + byte) % self.words.len().max(1)).copied().unwrap_or(0)
                };
                u32::from_be_bytes([at(0), at(1), at(2), at(3)])
            }
        }
    }
}

impl Line for Replies<'_> {
    fn name(&self) -> &str {
        "input"
    }

    fn baud(&self) -> u32 {
        115_200
    }

    fn time(&self) -> Duration {
        self.time
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut rest = bytes;
        while rest.len() >= HEADER {
            let (command, count) = (rest[0], usize::from(rest[1]));
            let address = 4 * u32::from_be_bytes([rest[2], rest[3], rest[4], rest[5]]);
            rest = &rest[HEADER..];
            if command == WRITE {
                for (index, word) in rest.chunks_exact(4).take(count).enumerate() {
                    let word = u32::from_be_bytes([word[0], word[1], word[2], word[3]]);
                    // A word written stands, or is the input's again.
                    if self.fault & 8 == 0 {
                        self.written.insert(address + 4 * index as u32, word);
                    }
                }
                rest = &rest[rest.len().min(4 * count)..];
            } else if command == READ {
                let mut answer: Vec<u8> = (0..count as u32)
                    .flat_map(|index| self.word(address + 4 * index).to_be_bytes())
                    .collect();
                self.answers = self.answers.saturating_add(1);
                if self.answers > self.whole {
                    match self.fault % 4 {
                        0 => {}
                        1 => answer.truncate(answer.len() / 2),
                        2 => answer.extend(answer.clone()),
                        _ => answer[0] ^= self.answers,
                    }
                }
                self.leaving.extend(answer);
            }
        }
        Ok(())
    }

    fn receive(&mut self, most: usize, patience: Duration) -> io::Result<Vec<u8>> {
        self.time += if self.leaving.is_empty() { patience } else { Duration::from_micros(100) };
        let count = most.min(self.leaving.len());
        Ok(self.leaving.drain(..count).collect())
    }
}

/// Opens the board, looks twice, and says what is wrong with it.
pub fn run(bytes: &[u8]) {
    let Some(([whole, fault, stages], words)) = bytes.split_first_chunk::<3>() else { return };
    let line = Replies {
        words,
        whole: *whole,
        fault: *fault,
        answers: 0,
        written: BTreeMap::new(),
        leaving: VecDeque::new(),
        time: Duration::ZERO,
    };
    let Ok(mut board) = Board::open(line, Duration::from_millis(1)) else { return };
    let _ = board.registers();
    // As many as a design can have: layers and two.
    let stages = 2 + usize::from(stages % 12);
    let (before, after) = (board.look(stages), board.look(stages));
    if let (Ok(before), Ok(after)) = (before, after) {
        let _ = findings(&KC705, &after);
        let _ = report(&before, &after, 1.0, 100.0);
    }
}

/// A board at rest, and three faulty lines.
pub fn seeds() -> Vec<Vec<u8>> {
    let words: Vec<u8> = (0..=255).collect();
    [[255, 0, 4], [3, 1, 4], [5, 2, 4], [7, 3, 4]].map(|first| [&first[..], &words].concat()).to_vec()
}
