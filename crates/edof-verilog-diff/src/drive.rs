//! The ports of a circuit by name, and values for them.

use rust_hdl::prelude::{Bits, Clock, In, Signal, Signed};

/// A type that a port can carry: made from a bit pattern.
pub trait Word {
    /// The value with these bits, the lowest first; others are ignored.
    fn word(bits: u128) -> Self;
}

impl Word for bool {
    fn word(bits: u128) -> Self {
        bits & 1 == 1
    }
}

impl<const N: usize> Word for Bits<N> {
    fn word(bits: u128) -> Self {
        let set = |value: Self, at: usize| value.replace_bit(at, bits >> at & 1 == 1);
        (0..N.min(128)).fold(Self::default(), set)
    }
}

impl<const N: usize> Word for Signed<N> {
    fn word(bits: u128) -> Self {
        let top = bits >> (N - 1) & 1 == 1;
        let value = if top { bits as i128 - (1 << N) } else { bits as i128 };
        Self::from(i64::try_from(value).unwrap_or_default())
    }
}

/// Sets a field of a circuit.
pub type Set<C> = Box<dyn Fn(&mut C, u128)>;

/// An input of a circuit.
pub struct Input<C> {
    /// The field as Rust writes it, for instance `stream.valid`.
    pub field: String,
    /// Sets it.
    pub set: Set<C>,
}

/// Finds a circuit's clock.
pub type ClockOf<C> = fn(&mut C) -> &mut Signal<In, Clock>;

/// What drives a circuit: its clock and all its other inputs.
pub struct Harness<C> {
    /// The clock; none for a circuit without registers.
    pub clock: Option<ClockOf<C>>,
    /// The other inputs.
    pub inputs: Vec<Input<C>>,
}

/// The harness of a circuit: type, clock (or `-`), and the inputs.
///
/// `harness!(Uart, clock; reset, send.valid, send.data)`
#[macro_export]
macro_rules! harness {
    ($circuit:ty, -; $($first:ident $(. $rest:ident)*),* $(,)?) => {
        $crate::Harness::<$circuit> { clock: None, inputs: $crate::harness!(@inputs $circuit; $($first $(. $rest)*),*) }
    };
    ($circuit:ty, $clock:ident; $($first:ident $(. $rest:ident)*),* $(,)?) => {
        $crate::Harness::<$circuit> {
            clock: Some(|circuit| &mut circuit.$clock),
            inputs: $crate::harness!(@inputs $circuit; $($first $(. $rest)*),*),
        }
    };
    (@inputs $circuit:ty; $($first:ident $(. $rest:ident)*),*) => {
        vec![$($crate::Input::<$circuit> {
            field: concat!(stringify!($first) $(, ".", stringify!($rest))*).into(),
            set: Box::new(|circuit: &mut $circuit, bits| circuit.$first $(. $rest)*.next = $crate::Word::word(bits)),
        }),*]
    };
}

/// A small generator of random numbers (xorshift), the same for the same seed.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The generator of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// 64 random bits.
    pub fn draw(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.draw() >> 32) as usize) % count.max(1)
    }

    /// Whether an event with this chance in 256 happens.
    pub fn chance(&mut self, of_256: usize) -> bool {
        self.below(256) < of_256
    }

    /// A bit pattern of some width, extremes and small numbers more often than others: there meanings part.
    pub fn word(&mut self, bits: usize) -> u128 {
        let mask = if bits >= 128 { u128::MAX } else { (1 << bits) - 1 };
        match self.below(8) {
            0 => 0,
            1 => mask,
            2 => ((mask >> 1) + 1) & mask,
            3 => mask >> 1,
            4 => u128::from(self.draw() % 8) & mask,
            _ => (u128::from(self.draw()) << 64 | u128::from(self.draw())) & mask,
        }
    }
}
