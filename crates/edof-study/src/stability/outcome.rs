//! The measurements of a case, against its limit.

use crate::stability::case::{Case, Promise, short};
use serde::Serialize;

/// One thing that a case measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measurement {
    /// Method, solver or network, its precision, and where it matters the stage.
    pub subject: String,
    /// What was measured, as in `dB below demosaicing`.
    pub what: String,
    /// The worst of it.
    pub worst: f64,
    /// The most that is allowed.
    pub limit: f64,
    /// Whether the limit is met. A NaN never meets it.
    pub held: bool,
    /// Something to know, such as what was counted.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// Distances and bounds of one stage, where that is what was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<StageMeasurement>,
}

/// One stage of a network against an a-priori bound; distances in LSB of its results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageMeasurement {
    /// I, M1, M2, …, F.
    pub stage: String,
    /// What it is compared with.
    pub against: &'static str,
    /// The bound of that result which came nearest to its own.
    pub bound: f64,
    /// How far off it was.
    pub seen: f64,
    /// The largest bound of all results.
    pub largest_bound: f64,
    /// The furthest that any result was off.
    pub furthest: f64,
    /// What nothing should exceed if roundings were independent and every code open, for rounding in flight alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistical: Option<f64>,
    /// Results beyond their bounds.
    pub violations: u64,
    /// Windows looked at.
    pub windows: u64,
}

impl Measurement {
    /// A measured value against its limit.
    #[must_use]
    pub fn new(subject: impl Into<String>, what: impl Into<String>, worst: f64, limit: f64) -> Self {
        let (subject, what) = (subject.into(), what.into());
        Self { subject, what, worst, limit, held: worst <= limit, note: String::new(), stage: None }
    }

    /// Something that is so or not.
    #[must_use]
    pub fn fact(subject: impl Into<String>, what: impl Into<String>, held: bool) -> Self {
        Self::new(subject, what, if held { 0.0 } else { 1.0 }, 0.0)
    }

    /// With a remark.
    #[must_use]
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// How much of the limit is used: 1 at the limit, more beyond. Facts have none.
    #[must_use]
    pub fn share(&self) -> f64 {
        match (self.held, self.limit > 0.0) {
            (_, true) if self.worst.is_finite() => (self.worst / self.limit).max(0.0),
            (true, _) => 0.0,
            (false, _) => f64::INFINITY,
        }
    }

    /// As a sentence.
    #[must_use]
    pub fn words(&self) -> String {
        let note = if self.note.is_empty() { String::new() } else { format!(" ({})", self.note) };
        if self.limit == 0.0 && self.worst <= 1.0 && self.worst.fract() == 0.0 {
            let held = if self.held { "yes" } else { "NO" };
            return format!("{}: {}: {held}{note}", self.subject, self.what);
        }
        let (worst, limit) = (short(self.worst), short(self.limit));
        format!("{}: {}: {worst}, limit {limit}{note}", self.subject, self.what)
    }
}

/// A case that was run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// The case.
    #[serde(flatten)]
    pub case: Case,
    /// Everything that was measured.
    pub seen: Vec<Measurement>,
    /// Number of saturated words, sums and displayed values.
    pub saturations: u64,
    /// What stopped it, if anything did.
    pub failure: Option<String>,
    /// Whether the case is within its limit.
    pub held: bool,
    /// Seconds it took.
    pub seconds: f64,
    /// PNG bytes of what it is about.
    #[serde(skip)]
    pub picture: Option<Vec<u8>>,
}

impl Outcome {
    /// What came nearest to its limit, or furthest beyond; of equals the first.
    #[must_use]
    pub fn worst(&self) -> Option<&Measurement> {
        // What only is so or not says less than anything measured, as long as it is so.
        let near = |seen: &Measurement| match (seen.held, seen.limit > 0.0) {
            (false, _) => f64::INFINITY,
            (true, true) => seen.worst / seen.limit,
            (true, false) => f64::NEG_INFINITY,
        };
        self.seen.iter().rev().max_by(|a, b| near(a).total_cmp(&near(b)))
    }

    /// How much of its limit the worst of it uses.
    #[must_use]
    pub fn share(&self) -> f64 {
        match (self.held, self.worst()) {
            (true, Some(worst)) => worst.share(),
            (true, None) => 0.0,
            (false, _) => f64::INFINITY,
        }
    }

    /// The first exceeded limit.
    #[must_use]
    pub fn broken(&self) -> Option<String> {
        let seen = || self.seen.iter().find(|seen| !seen.held).map(Measurement::words);
        if self.held { None } else { self.failure.clone().or_else(seen) }
    }
}

/// What a trial gives back.
#[derive(Debug, Default)]
pub struct TrialResult {
    /// Everything that was measured.
    pub seen: Vec<Measurement>,
    /// Saturations.
    pub saturations: u64,
    /// PNG bytes.
    pub picture: Option<Vec<u8>>,
}

impl TrialResult {
    /// Measurements without saturations or picture.
    #[must_use]
    pub fn of(seen: Vec<Measurement>) -> Self {
        Self { seen, ..Self::default() }
    }

    /// With a picture of the case.
    #[must_use]
    pub fn shown(mut self, picture: Option<Vec<u8>>) -> Self {
        self.picture = picture;
        self
    }
}

/// The verdict on a trial that ended by itself, by an error, or by a panic.
#[must_use]
pub fn judged(case: &Case, tried: Result<TrialResult, Stopped>, seconds: f64) -> Outcome {
    let (tried, failure) = match (tried, &case.promise) {
        (Err(Stopped::Refused(message)), Promise::Refused { says }) => {
            let seen = Measurement::fact("message", format!("holds “{says}”"), message.contains(says));
            (TrialResult::of(vec![seen.noted(message)]), None)
        }
        (Ok(tried), Promise::Refused { .. }) => (tried, Some("was not refused".to_owned())),
        (Ok(tried), _) => (tried, None),
        (Err(Stopped::Refused(message)), _) => {
            (TrialResult::default(), Some(format!("was refused: {message}")))
        }
        (Err(Stopped::Panicked(message)), _) => {
            (TrialResult::default(), Some(format!("panicked: {message}")))
        }
    };
    let held = failure.is_none() && !tried.seen.is_empty() && tried.seen.iter().all(|seen| seen.held);
    let TrialResult { seen, saturations, picture } = tried;
    Outcome { case: case.clone(), seen, saturations, failure, held, seconds, picture }
}

/// Why a trial did not end by itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stopped {
    /// An error.
    Refused(String),
    /// A panic: a failure with any limit.
    Panicked(String),
}

impl<E: std::error::Error> From<E> for Stopped {
    fn from(error: E) -> Self {
        Self::Refused(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::case::{System, Trial};

    fn case(promise: Promise) -> Case {
        let words = || "w".to_owned();
        let trial = Trial::Solve(System::TwinInputs);
        Case { id: words(), intent: words(), danger: words(), trial, promise, slow: false }
    }

    #[test]
    fn a_promise_holds_only_where_something_was_seen_and_all_of_it_is_within_its_limit() {
        let same = case(Promise::Same { error: 1.0, because: String::new(), except: vec![] });
        let seen = |worst| Measurement::new("s", "w", worst, 1.0);
        let held = |values: &[f64]| {
            judged(&same, Ok(TrialResult::of(values.iter().copied().map(seen).collect())), 0.0).held
        };
        assert!(held(&[0.5, 1.0]) && !held(&[0.5, 1.1]) && !held(&[f64::NAN]) && !held(&[]));
        assert!(!judged(&same, Err(Stopped::Refused("no".into())), 0.0).held);
    }

    #[test]
    fn a_refusal_holds_where_its_words_are_said_and_a_panic_never() {
        let refused = case(Promise::Refused { says: "must be 8".into() });
        let verdict = |stopped| judged(&refused, Err(stopped), 0.0);
        assert!(verdict(Stopped::Refused("depth 7: must be 8 to 16".into())).held);
        assert!(!verdict(Stopped::Refused("no".into())).held);
        assert!(!verdict(Stopped::Panicked("must be 8".into())).held);
        assert_eq!(judged(&refused, Ok(TrialResult::default()), 0.0).broken().unwrap(), "was not refused");
    }

    #[test]
    fn the_worst_is_what_is_nearest_to_its_limit() {
        let same = case(Promise::Same { error: 1.0, because: String::new(), except: vec![] });
        let all = vec![
            Measurement::new("a", "w", 5.0, 10.0),
            Measurement::new("b", "w", 0.9, 1.0),
            Measurement::fact("c", "w", true),
        ];
        let outcome = judged(&same, Ok(TrialResult::of(all)), 0.0);
        assert_eq!((outcome.worst().unwrap().subject.as_str(), outcome.share()), ("b", 0.9));
    }
}
