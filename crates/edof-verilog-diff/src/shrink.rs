//! A shorter stimulus on which simulations still differ.

use crate::failure::{Failure, Place};

/// Runs that shrinking takes at most.
const RUNS: usize = 300;

/// Whether, and where, the simulations differ on a stimulus.
pub type Differ<'a> = dyn Fn(&[Vec<u128>]) -> Result<Option<Place>, Failure> + 'a;

/// Cuts rows and clears values as long as a difference is left. The first `kept` rows stay: the reset.
pub fn shrink(
    rows: Vec<Vec<u128>>,
    kept: usize,
    differ: &Differ<'_>,
) -> Result<(Vec<Vec<u128>>, Place), Failure> {
    let mut shrinking = Shrinking { rows, place: None, runs: 0, differ };
    shrinking.attempt(shrinking.rows.clone())?;
    shrinking.rows_away(kept)?;
    shrinking.values_away(kept)?;
    match shrinking.place {
        Some(place) => Ok((shrinking.rows, place)),
        None => Err(Failure::NeverSettles { cycle: 0 }),
    }
}

struct Shrinking<'a> {
    rows: Vec<Vec<u128>>,
    place: Option<Place>,
    runs: usize,
    differ: &'a Differ<'a>,
}

impl Shrinking<'_> {
    /// Takes these rows if the simulations differ on them, and cuts them behind the difference.
    fn attempt(&mut self, rows: Vec<Vec<u128>>) -> Result<bool, Failure> {
        if self.runs > RUNS {
            return Ok(false);
        }
        self.runs += 1;
        let found = (self.differ)(&rows)?;
        if let Some(place) = found {
            self.rows = rows;
            self.rows.truncate(place.cycle + 1);
            self.place = Some(place);
        }
        Ok(found.is_some())
    }

    fn rows_away(&mut self, kept: usize) -> Result<(), Failure> {
        let mut size = self.rows.len().saturating_sub(kept) / 2;
        while size > 0 {
            let mut at = kept;
            while at + size < self.rows.len() {
                let mut rows = self.rows.clone();
                rows.drain(at..at + size);
                if !self.attempt(rows)? {
                    at += size;
                }
            }
            size /= 2;
        }
        Ok(())
    }

    fn values_away(&mut self, kept: usize) -> Result<(), Failure> {
        let columns = self.rows.first().map_or(0, Vec::len);
        for column in 0..columns {
            let mut rows = self.rows.clone();
            rows.iter_mut().skip(kept).for_each(|row| row[column] = 0);
            if self.attempt(rows)? {
                continue;
            }
            let mut row = kept;
            while row < self.rows.len() {
                if self.rows[row][column] != 0 {
                    let mut rows = self.rows.clone();
                    rows[row][column] = 0;
                    self.attempt(rows)?;
                }
                row += 1;
            }
        }
        Ok(())
    }
}
