//! Whole numbers that constants and parameters of leaves follow from, as `#[is(…)]` says.
//!
//! Rust and Verilog compute the same as long as no step is below 0 or needs more than 31 bits, so each step is checked.

use rust_hdl::prelude::{Bits, Constant, Synth};

/// Whole numbers below this are the same with and without a sign.
const LIMIT: u64 = 1 << 31;

/// The type of a constant that is a whole number.
pub trait Whole: Synth {
    /// The number of a value.
    fn number(self) -> u64;
    /// The value of a number; none if it does not fit.
    fn of(number: u64) -> Option<Self>;
}

impl<const N: usize> Whole for Bits<N> {
    fn number(self) -> u64 {
        self.to_u64()
    }

    fn of(number: u64) -> Option<Self> {
        (N >= 64 || number >> N == 0).then(|| number.into())
    }
}

impl Whole for bool {
    fn number(self) -> u64 {
        self.into()
    }

    fn of(number: u64) -> Option<Self> {
        (number < 2).then_some(number == 1)
    }
}

/// The number of a constant.
///
/// # Panics
/// If it has more than 31 bits.
#[must_use]
pub fn whole<T: Whole>(constant: &Constant<T>) -> u64 {
    checked(Some(constant.val().number()))
}

/// A constant that is this number.
///
/// # Panics
/// If its type cannot hold the number.
#[must_use]
pub fn constant<T: Whole>(number: u64) -> Constant<T> {
    Constant::new(T::of(number).unwrap_or_else(|| {
        panic!("a constant that follows from others is {number}, which its type cannot hold")
    }))
}

fn checked(step: Option<u64>) -> u64 {
    step.filter(|number| *number < LIMIT)
        .expect("a step of a formula is below 0, above 31 bits or divides by 0")
}

/// The sum.
#[must_use]
pub fn add(x: u64, y: u64) -> u64 {
    checked(x.checked_add(y))
}

/// The difference.
#[must_use]
pub fn subtract(x: u64, y: u64) -> u64 {
    checked(x.checked_sub(y))
}

/// The product.
#[must_use]
pub fn multiply(x: u64, y: u64) -> u64 {
    checked(x.checked_mul(y))
}

/// The quotient, rounded down.
#[must_use]
pub fn divide(x: u64, y: u64) -> u64 {
    checked(x.checked_div(y))
}

/// The remainder of a division.
#[must_use]
pub fn remainder(x: u64, y: u64) -> u64 {
    checked(x.checked_rem(y))
}

/// 1 where x is more than y, else 0.
#[must_use]
pub fn is_more(x: u64, y: u64) -> u64 {
    (x > y).into()
}

/// 1 where x is y, else 0.
#[must_use]
pub fn is_equal(x: u64, y: u64) -> u64 {
    (x == y).into()
}
