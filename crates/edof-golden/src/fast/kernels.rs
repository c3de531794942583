//! Matrix products on the kernels of an instruction set.

use super::active::Active;
use super::columns::Columns;
use super::isa::{Isa, for_each_isa};
use super::operands::Inputs;
use super::pack::{PANEL, Packed};
use super::portable;
use super::sums::Sums;
#[cfg(target_arch = "x86_64")]
use super::x86::{avx2, avx512, vnni};

for_each_isa! {
    /// The largest of words of 0 or more; −1 where one is negative.
    pub fn largest(words: &[i16]) -> i16 {
        let min = words.iter().copied().fold(0, i16::min);
        let max = words.iter().copied().fold(0, i16::max);
        if min < 0 { -1 } else { max }
    }
}

/// A matrix times vectors of `2 · matrix.pairs` words, into `matrix.rows` sums each.
pub fn dense(isa: Isa, matrix: &Packed, inputs: Inputs<'_>, sums: &mut Sums) {
    // The bound of 32-bit blocks holds for words of 0 or more, which is what windows hold.
    let isa = if inputs.largest.contains(&-1) { Isa::Portable } else { isa };
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2(token) => avx2::dense(token, matrix, inputs, sums),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512(token) => avx512::dense(token, matrix, inputs, sums),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512Vnni(token) => vnni::dense(token, matrix, inputs, sums),
        _ => {
            for (row, panel) in matrix.panels() {
                for (i, vector) in inputs.words.chunks_exact(2 * matrix.pairs).enumerate() {
                    let at = i * matrix.rows + row..i * matrix.rows + row + PANEL;
                    portable::dense(panel, vector, &mut sums.high[at.clone()], &mut sums.low[at]);
                }
            }
        }
    }
}

/// A matrix times the first `count` sparse vectors, into `matrix.rows` sums each. A panel stays in the first cache while all vectors
/// pass.
pub fn sparse(isa: Isa, matrix: &Columns, active: &Active, count: usize, sums: &mut Sums) {
    for (row, panel) in matrix.panels() {
        for i in 0..count {
            let at = i * matrix.rows + row..i * matrix.rows + row + PANEL;
            let (high, low) = (&mut sums.high[at.clone()], &mut sums.low[at]);
            let (isa, segments) = (if active.fits(i) { isa } else { Isa::Portable }, active.segments(i));
            match isa {
                #[cfg(target_arch = "x86_64")]
                Isa::Avx2(token) => avx2::sparse(token, panel, segments, high, low),
                #[cfg(target_arch = "x86_64")]
                Isa::Avx512(token) => avx512::sparse(token, panel, segments, high, low),
                #[cfg(target_arch = "x86_64")]
                Isa::Avx512Vnni(token) => vnni::sparse(token, panel, segments, high, low),
                _ => portable::sparse(panel, segments, high, low),
            }
        }
    }
}
