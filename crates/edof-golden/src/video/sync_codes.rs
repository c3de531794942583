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
