//! How far a study is, which part of it is measured, and how numbers are ordered.

use edof_core::Noise;

/// How far a study is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Progress {
    /// Rows done, those that were there included.
    pub done: usize,
    /// How many there will be.
    pub of: usize,
    /// What was measured last.
    pub last: String,
}

/// A number that has its place among all others.
#[derive(Debug, Clone, Copy)]
pub struct Ordered(pub f64);

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ordered {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ordered {}

impl Ordered {
    /// Numbers of a noise; none for none, which comes first.
    #[must_use]
    pub fn of_noise(noise: Noise) -> Vec<Self> {
        match noise {
            Noise::None => vec![],
            Noise::Gaussian { sigma } => vec![Self(sigma)],
            Noise::Sensor(s) => [s.gain, s.full_well_e, s.read_noise_e].map(Self).to_vec(),
        }
    }
}

/// A part of a study: every `of`-th of its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 0.
    index: usize,
    of: usize,
}

/// A text that names no shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("shard '{0}': must be I/N such as 2/8, I from 1 to N")]
pub struct ShardError(String);

impl std::str::FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let number = |word: &str| word.parse::<usize>().ok();
        match text.split_once('/').and_then(|(i, n)| number(i).zip(number(n))) {
            Some((i, of)) if 1 <= i && i <= of => Ok(Self { index: i - 1, of }),
            _ => Err(ShardError(text.to_owned())),
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.of)
    }
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    /// Rows of a study that belong to this share, each named by its key: every `of`-th in the keys' order, whatever the order they are given in. What
    /// is named twice counts once.
    #[must_use]
    pub fn own<K: Ord, T>(self, mut cells: Vec<(K, T)>) -> Vec<(K, T)> {
        cells.sort_by(|a, b| a.0.cmp(&b.0));
        cells.dedup_by(|a, b| a.0 == b.0);
        cells.into_iter().skip(self.index).step_by(self.of).collect()
    }
}
