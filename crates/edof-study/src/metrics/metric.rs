//! A metric as data: what it is called, what its numbers mean, and the function that measures it.

use crate::metrics::comparable::Pair;
use crate::metrics::number;
use serde::{Deserialize, Serialize};

/// A measure of how near a picture comes to the ground truth.
#[derive(Debug)]
pub struct Metric {
    /// Name in rows, JSON and Python.
    pub name: &'static str,
    /// Heading in tables.
    pub title: &'static str,
    /// Unit of its numbers; empty for a pure number.
    pub unit: &'static str,
    /// Which of two numbers is the better one.
    pub better: Better,
    /// Smallest side in pixels of a picture that it can measure, inside the border. Of smaller ones it gives no number.
    pub min_side: usize,
    /// Decimals in tables.
    pub decimals: usize,
    /// Where tables show it.
    pub place: Place,
    /// Measures a picture of at least that size.
    pub measure: fn(&Pair) -> Score,
}

/// Which of two numbers is the better one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Better {
    /// The higher one.
    Higher,
    /// The lower one.
    Lower,
}

/// Where tables show a metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In rows and JSON alone.
    Rows,
    /// In a column that every table has.
    Tables,
    /// In tables of all rows that hold it.
    Further,
}

/// Score of one picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number, \"inf\", \"-inf\" or \"nan\", or three of them")]
pub enum Score {
    /// One number.
    One(#[serde(with = "number")] f64),
    /// A number for each of red, green and blue.
    Colours(#[serde(with = "number::colours")] [f64; 3]),
}

impl Score {
    /// Returns the number, if it is one.
    #[must_use]
    pub const fn one(self) -> Option<f64> {
        match self {
            Self::One(value) => Some(value),
            Self::Colours(_) => None,
        }
    }
}

impl Metric {
    /// Returns the heading of a column: what the numbers are, their unit, and which are better where lower ones are.
    #[must_use]
    pub fn heading(&self) -> String {
        let better = if self.better == Better::Lower { " (lower is better)" } else { "" };
        format!("{}{better}", self.with_unit(self.title))
    }

    /// Returns a text followed by the unit, if there is one.
    #[must_use]
    pub fn with_unit(&self, text: &str) -> String {
        if self.unit.is_empty() { text.to_owned() } else { format!("{text} {}", self.unit) }
    }

    /// Returns a number as tables and programs print it, without its unit.
    #[must_use]
    pub fn digits(&self, value: f64) -> String {
        format!("{value:.*}", self.decimals)
    }
}
