//! Matrix products on the kernels of an instruction set.

use super::active::Active;
use super::isa::Isa;
use super::pack::{PANEL, Packed};
use super::portable;
use super::sums::Sums;
#[cfg(target_arch = "x86_64")]
use super::x86::{avx2, avx512};

/// A matrix times vectors of `2 · matrix.pairs` words that lie one after the other, into `matrix.rows` sums each.
pub fn dense(isa: Isa, matrix: &Packed, vectors: &[i16], sums: &mut Sums) {
    // The bound of 32-bit blocks holds for words of 0 or more, which is what windows hold.
    let isa = if vectors.iter().copied().fold(0, i16::min) < 0 { Isa::Portable } else { isa };
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2(token) => avx2::dense(token, matrix, vectors, sums),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512(token) => avx512::dense(token, matrix, vectors, sums),
        _ => {
            for (row, panel) in matrix.panels() {
                for (i, vector) in vectors.chunks_exact(2 * matrix.pairs).enumerate() {
                    let at = i * matrix.rows + row..i * matrix.rows + row + PANEL;
                    portable::dense(panel, vector, &mut sums.high[at.clone()], &mut sums.low[at]);
                }
            }
        }
    }
}

/// A matrix times sparse vectors that lie one after the other, `length` words from one to the next, into `matrix.rows` sums each. A panel
/// stays in the first cache while all vectors pass.
pub fn sparse(isa: Isa, matrix: &Packed, vectors: &[i16], length: usize, active: &Active, sums: &mut Sums) {
    for (row, panel) in matrix.panels() {
        for (i, vector) in vectors.chunks_exact(length).enumerate() {
            let at = i * matrix.rows + row..i * matrix.rows + row + PANEL;
            let (high, low) = (&mut sums.high[at.clone()], &mut sums.low[at]);
            match (isa, active.segments(i)) {
                #[cfg(target_arch = "x86_64")]
                (Isa::Avx2(token), Some(segments)) => avx2::sparse(token, panel, vector, segments, high, low),
                #[cfg(target_arch = "x86_64")]
                (Isa::Avx512(token), Some(segments)) => {
                    avx512::sparse(token, panel, vector, segments, high, low)
                }
                (_, Some(segments)) => {
                    let pairs = segments.flatten().map(|pair| usize::from(*pair));
                    portable::products(panel, vector, pairs, high, low);
                }
                (_, None) => portable::dense(panel, &vector[..2 * matrix.pairs], high, low),
            }
        }
    }
}
