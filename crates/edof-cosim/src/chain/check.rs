//! What should pass each boundary, and the first thing that did not; and that what waits there does not change.

use super::device::{Beat, Offer, join};
use crate::bench::StabilityCheck;
use edof_golden::cycle::{PatchRun, Transfer};
use edof_hdl::places::Place;
use edof_hdl::project::Project;
use serde::Serialize;
use std::collections::VecDeque;
use std::fmt;

/// How a beat differs from the model's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// The beat passes before its expected cycle.
    Early,
    /// The beat does not pass in its expected cycle.
    Late,
    /// A word to be multiplied, or of a result.
    Word,
    /// A word to be added to.
    Base,
    /// The mark of a vector's last beat.
    Last,
    /// The mark of the set.
    Set,
    /// A beat that changed or went while its receiver stalled.
    Held,
    /// A counter at the end of the run.
    Counter,
}

/// The first difference between a circuit and the model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// What differs.
    pub fault: Fault,
    /// The boundary, from sender to receiver, as in `I to M1`.
    pub boundary: String,
    /// The stage that sent it, or for the input the stage that takes it.
    pub stage: String,
    /// Which patch, 0 first.
    pub patch: u64,
    /// Which element of the vector.
    pub element: usize,
    /// The cycle in which it was seen, 0 the first after reset.
    pub cycle: u64,
    /// What the model says: a word, or a cycle for a beat that is early or late.
    pub expected: i64,
    /// What the circuit gave; nothing where nothing passed.
    pub got: Option<i64>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { boundary, stage, patch, element, cycle, expected, .. } = self;
        write!(f, "stage {stage} ({boundary}), patch {patch}, element {element}, cycle {cycle}: ")?;
        let got = self.got.map_or_else(|| "nothing".into(), |got| got.to_string());
        match self.fault {
            Fault::Early => write!(f, "expected in cycle {expected}, came in cycle {got}"),
            Fault::Late => write!(f, "expected in cycle {expected}, did not come"),
            Fault::Word => write!(f, "expected {expected}, got {got}"),
            Fault::Base => write!(f, "base: expected {expected}, got {got}"),
            Fault::Last => write!(f, "last: expected {expected}, got {got}"),
            Fault::Set => write!(f, "set: expected {expected}, got {got}"),
            Fault::Held => write!(f, "offered {expected} and not taken, then {got}"),
            Fault::Counter => write!(f, "counter {element}: expected {expected}, got {got}"),
        }
    }
}

impl Difference {
    /// What drives the signal that differs: in Verilog, and in the Rust that it was made from. None for files that are not what was generated.
    #[must_use]
    pub fn driver(&self, project: &Project, stages: usize) -> Option<Place> {
        let stage = stage_names(stages).iter().position(|name| *name == self.stage)?;
        let sends = self.boundary.starts_with(&format!("{} ", self.stage));
        let port = match self.fault {
            _ if !sends => "ready_o",
            Fault::Early | Fault::Late | Fault::Held => "out_valid_o",
            Fault::Word => "out_data_o",
            Fault::Base => "out_base_o",
            Fault::Last => "out_last_o",
            Fault::Set => "out_set_o",
            Fault::Counter => "status_o",
        };
        project.driver(&[&format!("stages_{stage}")], port)
    }
}

/// Names of a chain's stages: I, M1…, F.
#[must_use]
pub fn stage_names(stages: usize) -> Vec<String> {
    (0..stages)
        .map(|stage| match stage {
            0 => "I".into(),
            last if last + 1 == stages => "F".into(),
            middle => format!("M{middle}"),
        })
        .collect()
}

/// Names of a chain's boundaries, from the window to the patch, each with the stage that sends it; the first with the one that takes it.
#[must_use]
pub fn boundary_names(stages: usize) -> Vec<(String, String)> {
    let names = stage_names(stages);
    let ends = |boundary: usize| match boundary {
        0 => (format!("window to {}", names[0]), names[0].clone()),
        last if last == stages => (format!("{} to patch", names[last - 1]), names[last - 1].clone()),
        b => (format!("{} to {}", names[b - 1], names[b]), names[b - 1].clone()),
    };
    (0..=stages).map(ends).collect()
}

/// The beats that are still to come at one boundary.
#[derive(Debug)]
pub struct Boundary {
    name: String,
    stage: String,
    expected: VecDeque<(u64, usize, Transfer)>,
    /// Beats that passed as they should.
    pub passed: u64,
    /// What was offered and not taken.
    standing: StabilityCheck,
    stood: Option<Beat>,
    /// Whether base words mean something here.
    has_base: bool,
}

impl Boundary {
    /// Those of a chain, from the window to the patch.
    #[must_use]
    pub fn all(stages: usize) -> Vec<Self> {
        let boundary = |(boundary, (name, stage)): (usize, (String, String))| Self {
            name,
            stage,
            expected: VecDeque::new(),
            passed: 0,
            standing: StabilityCheck::default(),
            stood: None,
            has_base: (1..stages - 1).contains(&boundary),
        };
        boundary_names(stages).into_iter().enumerate().map(boundary).collect()
    }

    /// Expects the beats of a patch more.
    pub fn expect(&mut self, run: &PatchRun, boundary: usize) {
        let beats = run.transfers(boundary).enumerate();
        self.expected.extend(beats.map(|(beat, transfer)| (run.index, beat, transfer)));
    }

    /// The beat that comes next, if any is still to come.
    #[must_use]
    pub fn next(&self) -> Option<&Transfer> {
        self.expected.front().map(|(.., transfer)| transfer)
    }

    /// Compares what passes in a cycle, and sees that what does not pass stays as it is.
    ///
    /// # Errors
    /// The first difference.
    pub fn see(&mut self, cycle: u64, offer: Offer) -> Result<(), Box<Difference>> {
        self.holds(cycle, &offer)?;
        self.passes(cycle, offer.passes())
    }

    fn holds(&mut self, cycle: u64, offer: &Offer) -> Result<(), Box<Difference>> {
        let parts = offer.beat.map(|beat| {
            let base = if self.has_base { join(beat.base) } else { 0 };
            [join(beat.words), base, beat.last.into(), beat.set as u32]
        });
        if self.standing.broken(parts.as_ref().map(<[u32; 4]>::as_slice), offer.ready).is_none() {
            self.stood = offer.beat;
            return Ok(());
        }
        let word = |beat: Beat| i64::from(join(beat.words));
        let before = self.stood.map_or(0, word);
        Err(self.differs(Fault::Held, cycle, 0, before, offer.beat.map(word)))
    }

    fn passes(&mut self, cycle: u64, seen: Option<Beat>) -> Result<(), Box<Difference>> {
        let Some(due) = self.next().copied() else {
            return match seen {
                Some(_) => Err(self.differs(Fault::Early, cycle, 0, i64::MAX, Some(cycle as i64))),
                None => Ok(()),
            };
        };
        match seen {
            None if due.cycle > cycle => return Ok(()),
            None => return Err(self.differs(Fault::Late, cycle, 0, due.cycle as i64, None)),
            Some(_) if due.cycle > cycle => {
                return Err(self.differs(Fault::Early, cycle, 0, due.cycle as i64, Some(cycle as i64)));
            }
            Some(seen) => self.same(cycle, &due, &seen)?,
        }
        self.expected.pop_front();
        self.passed += 1;
        Ok(())
    }

    fn same(&self, cycle: u64, due: &Transfer, seen: &Beat) -> Result<(), Box<Difference>> {
        let mut pairs: Vec<(Fault, usize, i64, i64)> = Vec::with_capacity(6);
        for element in 0..due.words.len() {
            let (due, seen) = (due.words[element], seen.words[element]);
            pairs.push((Fault::Word, element, due.into(), seen.into()));
        }
        for (element, base) in due.base.iter().flatten().enumerate() {
            pairs.push((Fault::Base, element, (*base).into(), seen.base[element].into()));
        }
        pairs.push((Fault::Last, 0, due.last.into(), seen.last.into()));
        pairs.push((Fault::Set, 0, due.set as i64, seen.set as i64));
        let wrong = pairs.into_iter().find(|(_, _, due, seen)| due != seen);
        wrong.map_or(Ok(()), |(fault, element, due, seen)| {
            Err(self.differs(fault, cycle, element, due, Some(seen)))
        })
    }

    fn differs(
        &self,
        fault: Fault,
        cycle: u64,
        element: usize,
        expected: i64,
        got: Option<i64>,
    ) -> Box<Difference> {
        let (patch, beat) = self.expected.front().map_or((u64::MAX, 0), |(patch, beat, _)| (*patch, *beat));
        Box::new(Difference {
            fault,
            boundary: self.name.clone(),
            stage: self.stage.clone(),
            patch,
            element: 2 * beat + element,
            cycle,
            expected,
            got,
        })
    }
}
