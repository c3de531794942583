//! What kernels multiply by weights: whole vectors, and the words of sparse ones that are not zero.

/// Vectors that lie one after the other, and what bounds them.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// The words.
    pub words: &'a [i16],
    /// The largest of each vector; −1 where one is negative.
    pub largest: &'a [i16],
}

/// Active words and their columns: an even number, with a zero at the end where it takes one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entries<'a> {
    /// The words.
    pub words: &'a [i16],
    /// The column that each is multiplied by.
    pub columns: &'a [u16],
}

/// Entries that kernels may write beyond the last: whole vectors.
pub const SLACK: usize = 64;
