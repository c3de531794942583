//! Codes of line start and end inside of the pixels, counted.

/// The codes of progressive video with their parity: line start and end, in the picture and in vertical blanking.
const CODES: [u16; 4] = [0x8080, 0x9d9d, 0xabab, 0xb6b6];

/// Counts whole codes, and the words that spoil one, of a 16-bit bus whose bytes both carry the codes (ITU-R BT.1120).
#[derive(Debug, Clone)]
pub struct SyncCodes {
    words: [u16; 4],
    /// Words of a whole code that are still to come.
    inside: u8,
    /// Whether the last whole code ended a line.
    ended: Option<bool>,
    /// Whole codes.
    pub codes: u32,
    /// 0 or 255 on either byte outside of a whole code, and lines that began or ended twice.
    pub malformed: u32,
}

impl Default for SyncCodes {
    fn default() -> Self {
        Self { words: [0x8010; 4], inside: 0, ended: None, codes: 0, malformed: 0 }
    }
}

impl SyncCodes {
    /// The next word.
    pub fn push(&mut self, word: u16) {
        self.words = [self.words[1], self.words[2], self.words[3], word];
        let is_whole = self.words[..3] == [0xffff, 0, 0] && CODES.contains(&word);
        let [upper, lower] = self.words[0].to_be_bytes();
        let is_edge = [upper, lower].iter().any(|byte| matches!(byte, 0 | 255));
        let mut is_damaged = is_edge && !is_whole && self.inside == 0;
        self.inside = self.inside.saturating_sub(1);
        if is_whole {
            let ends = word & 0x10 != 0;
            is_damaged |= self.ended == Some(ends);
            (self.inside, self.ended) = (3, Some(ends));
            self.codes = self.codes.wrapping_add(1);
        }
        self.malformed = self.malformed.wrapping_add(u32::from(is_damaged));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole codes and corrupted words of words that come after reset.
    fn counted(words: &[u16]) -> [u32; 2] {
        let mut found = SyncCodes::default();
        // What is pushed is judged three words later.
        words.iter().chain(&[0x8010; 3]).for_each(|word| found.push(*word));
        [found.codes, found.malformed]
    }

    const fn code(last: u16) -> [u16; 4] {
        [0xffff, 0, 0, last]
    }

    const STARTS: [u16; 2] = [0x8080, 0xabab];
    const ENDS: [u16; 2] = [0x9d9d, 0xb6b6];

    #[test]
    fn lines_that_start_and_end_in_turn_have_two_codes_each() {
        for start in STARTS {
            for end in ENDS {
                let line = [&code(start)[..], &[0x1234, 0x8010], &code(end), &[0x8010]].concat();
                assert_eq!(counted(&line), [2, 0]);
                assert_eq!(counted(&[line.clone(), line.clone(), line].concat()), [6, 0]);
                // Without pixels as well.
                assert_eq!(counted(&[code(end), code(start), code(end)].concat()), [3, 0]);
            }
        }
        assert_eq!(counted(&[]), [0, 0]);
    }

    #[test]
    fn a_line_that_starts_or_ends_twice_is_malformed() {
        for pair in [STARTS, ENDS, [STARTS[1], STARTS[0]], [ENDS[0]; 2], [STARTS[0]; 2]] {
            assert_eq!(counted(&pair.map(code).concat()), [2, 1], "{pair:x?}");
        }
    }

    #[test]
    fn an_end_of_either_byte_range_spoils_a_word_outside_of_a_code() {
        for word in [0x0010, 0x8000, 0xff10, 0x80ff, 0, 0xffff, 0xff00] {
            assert_eq!(counted(&[0x8010, word, 0x8010]), [0, 1], "{word:x}");
            let around = [&code(0x8080)[..], &[word], &code(0x9d9d), &[word, word]].concat();
            assert_eq!(counted(&around), [2, 3], "{word:x}");
        }
        for word in [0x0110, 0x8001, 0xfe10, 0x80fe] {
            assert_eq!(counted(&[word]), [0, 0], "{word:x}");
        }
    }

    #[test]
    fn a_code_with_a_wrong_word_is_none_and_each_of_its_end_values_is_malformed() {
        assert_eq!(counted(&code(0x8081)), [0, 3]);
        assert_eq!(counted(&[0xffff, 0, 1, 0x8080]), [0, 3]);
        assert_eq!(counted(&[0xffff, 0, 0x1010, 0x8080]), [0, 2]);
        assert_eq!(counted(&[0xfeff, 0, 0, 0x8080]), [0, 3]);
        // The code that follows is whole.
        assert_eq!(counted(&[&[0xffff, 0], &code(0x9d9d)[..]].concat()), [1, 2]);
    }
}
