//! What all experiments share: their rows are known before any is measured; what a journal holds is not measured again, the rest is shared
//! out among machines, measured in order, and stopped where a listener says so.

use crate::journal::{Journal, JournalError, Key, Line, Progress, Proof, Shard};
use std::ops::ControlFlow;

/// An experiment.
pub trait Experiment {
    /// What it measures.
    type Row: Line;
    /// A row to be measured. Rows are measured in the order of their cells.
    type Cell: Ord;
    /// Why it failed.
    type Error;

    /// All of its rows: what each is of and measured from, and its cell.
    fn cells(&self) -> Vec<(Key<Self::Row>, Self::Cell)>;

    /// Whether a cell is measured together with the one before it.
    fn belongs_to(&self, _before: &Self::Cell, _cell: &Self::Cell) -> bool {
        false
    }

    /// Measures cells that belong together, at least one. Rows come back in any order.
    ///
    /// # Errors
    /// Those of the experiment.
    fn measure(&mut self, cells: &[(Self::Cell, Proof)]) -> Result<Vec<Self::Row>, Self::Error>;

    /// What a listener receives of a measured cell.
    fn describe(&self, cell: &Self::Cell) -> String;
}

/// An experiment that did not come to its end.
#[derive(Debug, thiserror::Error)]
pub enum RunError<E> {
    /// The experiment failed.
    #[error(transparent)]
    Experiment(E),
    /// The file of rows.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
}

/// Measures a shard's rows that the journal does not hold yet, and puts its rows into their order. `tell` hears of every measurement and may
/// stop the experiment; what was measured stays.
///
/// # Errors
/// [`RunError`].
pub fn run<E: Experiment>(
    experiment: &mut E,
    shard: Shard,
    journal: &mut Journal<E::Row>,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), RunError<E::Error>> {
    let own = shard.own(experiment.cells());
    let of = own.len();
    let mut missing: Vec<(E::Cell, Proof)> =
        own.into_iter().filter(|(key, _)| !journal.holds(key)).map(|(key, cell)| (cell, key.proof)).collect();
    missing.sort_by(|a, b| a.0.cmp(&b.0));
    let mut done = of - missing.len();
    let mut rest = &missing[..];
    while !rest.is_empty() {
        let together = |pair: &[(E::Cell, Proof)]| experiment.belongs_to(&pair[0].0, &pair[1].0);
        let count = 1 + rest.windows(2).take_while(|pair| together(pair)).count();
        let (cells, others) = rest.split_at(count);
        for row in experiment.measure(cells).map_err(RunError::Experiment)? {
            journal.push(row)?;
        }
        done += count;
        let last = experiment.describe(&cells[count - 1].0);
        if tell(Progress { done, of, last }).is_break() {
            return Err(RunError::Stopped);
        }
        rest = others;
    }
    Ok(journal.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::{Header, Program};
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Square {
        of: u32,
        is: u32,
        #[serde(flatten)]
        proof: Proof,
    }

    impl Line for Square {
        const STUDY: &'static str = "squares";
        const LAYOUT: u32 = 1;
        type Subject = u32;

        fn subject(&self) -> u32 {
            self.of
        }

        fn proof(&self) -> &Proof {
            &self.proof
        }

        fn timeless(&self) -> Self {
            self.clone()
        }
    }

    /// Squares of numbers below ten, measured in pairs from the largest down; which were, and how settings are called.
    struct Squares(Vec<Vec<u32>>, &'static str);

    impl Experiment for Squares {
        type Row = Square;
        type Cell = std::cmp::Reverse<u32>;
        type Error = String;

        fn cells(&self) -> Vec<(Key<Square>, Self::Cell)> {
            let proof = Proof { settings: Some(self.1.to_owned()), ..Proof::default() };
            (0..10).map(|of| (Key { subject: of, proof: proof.clone() }, std::cmp::Reverse(of))).collect()
        }

        fn belongs_to(&self, before: &Self::Cell, cell: &Self::Cell) -> bool {
            before.0 / 2 == cell.0 / 2
        }

        fn measure(&mut self, cells: &[(Self::Cell, Proof)]) -> Result<Vec<Square>, String> {
            self.0.push(cells.iter().map(|cell| cell.0.0).collect());
            let row = |(of, proof): &(Self::Cell, Proof)| match of.0 {
                6 if self.1 == "broken" => Err("no square of 6".to_owned()),
                of => Ok(Square { of, is: of * of, proof: proof.clone() }),
            };
            cells.iter().map(row).collect()
        }

        fn describe(&self, cell: &Self::Cell) -> String {
            format!("the square of {}", cell.0)
        }
    }

    fn journal() -> Journal<Square> {
        Journal::in_memory(Header::of::<Square>(Program::stub("r", "m")))
    }

    const ON: ControlFlow<()> = ControlFlow::Continue(());

    #[test]
    fn what_is_missing_is_measured_in_the_order_of_cells_and_what_belongs_together_at_once() {
        let (mut squares, mut journal) = (Squares(vec![], "s"), journal());
        let stop = |progress: Progress| {
            assert_eq!((progress.of, progress.last.as_str()), (10, "the square of 8"));
            ControlFlow::Break(())
        };
        let stopped = run(&mut squares, Shard::WHOLE, &mut journal, stop);
        assert!(matches!(stopped, Err(RunError::Stopped)));
        let mut told = vec![];
        run(&mut squares, Shard::WHOLE, &mut journal, |progress| {
            told.push(progress.done);
            ON
        })
        .unwrap();
        assert_eq!(squares.0, [[9, 8], [7, 6], [5, 4], [3, 2], [1, 0]]);
        assert_eq!(told, [4, 6, 8, 10]);
        assert_eq!(
            journal.rows().iter().map(|row| row.is).collect::<Vec<_>>(),
            [0, 1, 4, 9, 16, 25, 36, 49, 64, 81]
        );
    }

    #[test]
    fn rows_of_other_settings_are_measured_anew() {
        let mut journal = journal();
        run(&mut Squares(vec![], "s"), Shard::WHOLE, &mut journal, |_| ON).unwrap();
        let mut others = Squares(vec![], "t");
        run(&mut others, "1/5".parse().unwrap(), &mut journal, |_| ON).unwrap();
        assert_eq!(others.0, [vec![5], vec![0]]);
        let renewed = journal.rows().into_iter().filter(|row| row.proof.settings.as_deref() == Some("t"));
        assert_eq!(renewed.map(|row| row.of).collect::<Vec<_>>(), [0, 5]);
    }

    #[test]
    fn what_was_measured_before_a_failure_stays() {
        let mut journal = journal();
        let failed = run(&mut Squares(vec![], "broken"), Shard::WHOLE, &mut journal, |_| ON).unwrap_err();
        assert_eq!(failed.to_string(), "no square of 6");
        assert_eq!(journal.rows().len(), 2);
    }
}
