//! From accumulators to words: round, shift, saturate; soft threshold; difference. Each function is plain Rust that is
//! compiled once for every instruction set, and gives how many words saturated.

use super::isa::Isa;
use edof_spec::fixed_network::FinalShifts;
use edof_spec::network::Shrinkage;

/// How an I or M stage ends.
#[derive(Debug, Clone, Copy)]
pub struct Finish {
    /// Left shift of the base.
    pub base_shift: u32,
    /// Right shift of the sum.
    pub shift: u32,
    /// Bits of a word.
    pub bits: u32,
}

/// The soft threshold of a stage.
#[derive(Debug, Clone, Copy)]
pub struct Threshold<'a> {
    /// Two- or one-sided.
    pub shrinkage: Shrinkage,
    /// θ of each pre-activation.
    pub theta: &'a [i16],
    /// Bits of a word.
    pub bits: u32,
}

/// Defines a function that runs the given body, compiled for the wanted instruction set.
macro_rules! for_each_isa {
    ($(#[$doc:meta])* $name:ident($($arg:ident: $type:ty),*) -> u64 $body:block) => {
        $(#[$doc])*
        pub fn $name(isa: Isa, $($arg: $type),*) -> u64 {
            #[inline(always)]
            fn body($($arg: $type),*) -> u64 $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($arg: $type),*) -> u64 { body($($arg),*) }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
            fn avx512($($arg: $type),*) -> u64 { body($($arg),*) }

            match isa {
                Isa::Portable => body($($arg),*),
                // SAFETY: the token proves that this machine has these instructions.
                #[cfg(target_arch = "x86_64")]
                Isa::Avx2(_) => unsafe { avx2($($arg),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                Isa::Avx512(_) => unsafe { avx512($($arg),*) },
                #[cfg(not(target_arch = "x86_64"))]
                _ => body($($arg),*),
            }
        }
    };
}

for_each_isa! {
    /// `(base << base_shift) + sum`, rounded, shifted and saturated to its width.
    words(finish: Finish, sums: &[i64], base: Option<&[i16]>, out: &mut [i16]) -> u64 {
        let round = rounding(finish.shift);
        let most = (1i64 << (finish.bits - 1)) - 1;
        let mut saturated = 0;
        let mut finish_one = |out: &mut i16, sum: i64| {
            let word = (sum + round) >> finish.shift;
            let held = word.clamp(-most - 1, most);
            saturated += u64::from(held != word);
            *out = held as i16;
        };
        match base {
            None => out.iter_mut().zip(sums).for_each(|(out, sum)| finish_one(out, *sum)),
            Some(base) => out.iter_mut().zip(sums).zip(base).for_each(|((out, sum), base)| {
                finish_one(out, (i64::from(*base) << finish.base_shift) + sum);
            }),
        }
        saturated
    }
}

for_each_isa! {
    /// F's words: `(D·z << dictionary) + (R·y << linear_path)`, rounded, shifted and saturated to 16 bits.
    outputs(shifts: FinalShifts, sums: &[i64], linear: Option<&[i64]>, out: &mut [i16]) -> u64 {
        let round = rounding(shifts.result);
        let mut saturated = 0;
        let mut finish_one = |out: &mut i16, sum: i64| {
            let word = (sum + round) >> shifts.result;
            let held = word.clamp(i64::from(i16::MIN), i64::from(i16::MAX));
            saturated += u64::from(held != word);
            *out = held as i16;
        };
        match linear {
            None => out.iter_mut().zip(sums).for_each(|(out, sum)| finish_one(out, sum << shifts.dictionary)),
            Some(linear) => out.iter_mut().zip(sums).zip(linear).for_each(|((out, sum), linear)| {
                finish_one(out, (sum << shifts.dictionary) + (linear << shifts.linear_path));
            }),
        }
        saturated
    }
}

for_each_isa! {
    /// The soft threshold of each pre-activation.
    shrink(threshold: Threshold<'_>, b: &[i16], z: &mut [i16]) -> u64 {
        let most = (1i32 << (threshold.bits - 1)) - 1;
        let mut saturated = 0u32;
        let mut finish_one = |z: &mut i16, word: i32| {
            let held = word.clamp(-most - 1, most);
            saturated += u32::from(held != word);
            *z = held as i16;
        };
        let each = z.iter_mut().zip(b).zip(threshold.theta);
        match threshold.shrinkage {
            Shrinkage::OneSided => {
                each.for_each(|((z, b), theta)| finish_one(z, (i32::from(*b) - i32::from(*theta)).max(0)));
            }
            Shrinkage::TwoSided => each.for_each(|((z, b), theta)| {
                let size = (i32::from(*b).abs() - i32::from(*theta)).max(0);
                finish_one(z, if *b < 0 { -size } else { size });
            }),
        }
        saturated.into()
    }
}

for_each_isa! {
    /// `z − previous`, saturated to its width.
    difference(bits: u32, z: &[i16], previous: &[i16], out: &mut [i16]) -> u64 {
        let most = (1i32 << (bits - 1)) - 1;
        let mut saturated = 0u32;
        for ((out, z), previous) in out.iter_mut().zip(z).zip(previous) {
            let word = i32::from(*z) - i32::from(*previous);
            let held = word.clamp(-most - 1, most);
            saturated += u32::from(held != word);
            *out = held as i16;
        }
        saturated.into()
    }
}

for_each_isa! {
    /// How many words are not zero.
    nonzeros(words: &[i16]) -> u64 {
        words.iter().map(|w| u16::from(*w != 0)).sum::<u16>().into()
    }
}

for_each_isa! {
    /// Bit i tells whether word i (of at most 64) is not zero.
    nonzero_mask(words: &[i16]) -> u64 {
        let bytes = words.chunks(8).map(|eight| {
            eight.iter().enumerate().map(|(i, w)| u8::from(*w != 0) << i).fold(0, |byte, bit| byte | bit)
        });
        bytes.enumerate().map(|(i, byte)| u64::from(byte) << (8 * i)).fold(0, |mask, byte| mask | byte)
    }
}

/// What is added before shifting right by `shift`.
const fn rounding(shift: u32) -> i64 {
    if shift == 0 { 0 } else { 1 << (shift - 1) }
}
