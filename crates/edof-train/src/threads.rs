//! Threads of a training run.

use crate::recipe::{RecipeError, value};

/// # Errors
/// [`RecipeError`] for a number of threads that no run can have.
pub fn check_threads(threads: usize) -> Result<(), RecipeError> {
    (1..=256).contains(&threads).then_some(()).ok_or_else(|| value("threads", threads, "1 to 256"))
}

/// Threads of a training run.
#[derive(Debug)]
pub(crate) enum Pool {
    Own(rayon::ThreadPool),
    /// That of the caller, where the system starts no others.
    Shared,
}

impl Pool {
    /// As many threads as are wanted, or as a limit of the system allows: weights do not depend on the number.
    ///
    /// # Errors
    /// As [`check_threads`].
    pub fn new(threads: usize) -> Result<Self, RecipeError> {
        check_threads(threads)?;
        let counts =
            std::iter::successors(Some(threads), |count| Some(count / 2)).take_while(|count| *count > 0);
        let mut pools =
            counts.filter_map(|count| rayon::ThreadPoolBuilder::new().num_threads(count).build().ok());
        Ok(pools.next().map_or(Self::Shared, Self::Own))
    }

    /// Runs work in the pool.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match self {
            Self::Own(pool) => pool.install(work),
            Self::Shared => work(),
        }
    }
}
