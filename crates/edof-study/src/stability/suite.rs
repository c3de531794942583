//! The suite: cases run one after the other, each on all threads, and what they say together.

use crate::stability::bench::Bench;
use crate::stability::case::{Case, Trial};
use crate::stability::outcome::{Outcome, Stopped, TrialResult, judged};
use crate::stability::{
    bounds, deblurring, fitting, frames, lenses, numbers, pursuits, refusals, sizes, solves, words,
};
use serde::Serialize;
use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

impl Bench {
    /// Runs one case.
    #[must_use]
    pub fn run(&self, case: &Case) -> Outcome {
        let start = Instant::now();
        let tried = catch_unwind(AssertUnwindSafe(|| self.tried(case)));
        let tried = tried.unwrap_or_else(|panic| Err(Stopped::Panicked(message(panic.as_ref()))));
        judged(case, tried, start.elapsed().as_secs_f64())
    }

    fn tried(&self, case: &Case) -> Result<TrialResult, Stopped> {
        let promise = &case.promise;
        match &case.trial {
            Trial::Frame(frame) => frames::frame(self, frame, promise),
            Trial::Phase { taken, read } => frames::phase(*taken, *read),
            Trial::Size { height, width } => sizes::size(self, *height, *width),
            Trial::Megapixels(count) => sizes::megapixels(self, *count, promise),
            Trial::Words(given) => words::words(self, given),
            Trial::Bounds { network } => bounds::bounds(self, network),
            Trial::Pursuit { dictionary, signals, penalty, steps } => {
                Ok(pursuits::pursuit(*dictionary, *signals, *penalty, *steps, promise))
            }
            Trial::Learning { dictionary } => Ok(pursuits::learning(*dictionary, promise)),
            Trial::Solve(system) => solves::solve(&self.subjects, *system, promise),
            Trial::Fitted { trained, met } => fitting::fitted(&self.subjects, *trained, *met, promise),
            Trial::Lens(lens) => lenses::lens(lens, promise),
            Trial::Deblur { picture, kernel, ratio, size } => {
                deblurring::deblur(picture, *kernel, *ratio as f32, *size, promise)
            }
            Trial::Numbers(given) => numbers::numbers(&self.subjects, *given, promise),
            Trial::Refusal(given) => refusals::refusal(self, *given),
        }
    }
}

/// What a panic says.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a word").to_owned()
}

/// All outcomes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suite {
    /// Those nearest to their limits first, broken ones before them.
    pub cases: Vec<Outcome>,
    /// Number of failed cases.
    pub broken: usize,
    /// Windows that bounds were tried on, for each network.
    pub windows: usize,
    /// Seconds in all.
    pub seconds: f64,
}

impl Suite {
    /// Runs cases; `tell` hears what comes next and may stop it.
    pub fn run(
        bench: &Bench,
        cases: &[Case],
        mut tell: impl FnMut(usize, &Case) -> ControlFlow<()>,
    ) -> Option<Self> {
        let start = Instant::now();
        let mut outcomes = vec![];
        for (index, case) in cases.iter().enumerate() {
            if tell(index, case).is_break() {
                return None;
            }
            outcomes.push(bench.run(case));
        }
        outcomes.sort_by(|a, b| b.share().total_cmp(&a.share()).then(a.case.id.cmp(&b.case.id)));
        let broken = outcomes.iter().filter(|outcome| !outcome.held).count();
        Some(Self { cases: outcomes, broken, windows: bench.windows, seconds: start.elapsed().as_secs_f64() })
    }

    /// The ids of broken cases.
    #[must_use]
    pub fn broken(&self) -> Vec<&str> {
        self.cases.iter().filter(|outcome| !outcome.held).map(|outcome| outcome.case.id.as_str()).collect()
    }
}
