//! Which instruction set a kernel is compiled for. One that a machine may lack comes with a token, which detection alone gives:
//! who holds it may run the kernel.

/// Proof that this machine has AVX2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx2(());

/// Proof that this machine has AVX-512 F, BW, DQ, VL and VNNI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx512(());

/// Instruction sets that have kernels of their own.
///
/// What a machine was not seen to have cannot be named:
/// ```compile_fail
/// use edof_golden::fast::isa::{Avx512, Isa};
/// let isa = Isa::Avx512(Avx512(()));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Isa {
    /// Plain Rust.
    Portable,
    /// AVX2.
    Avx2(Avx2),
    /// AVX-512.
    Avx512(Avx512),
}

impl Isa {
    /// Those that this machine can run, slowest first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut all = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx2") {
                all.push(Self::Avx2(Avx2(())));
            }
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512vnni")
            {
                all.push(Self::Avx512(Avx512(())));
            }
        }
        all
    }

    /// The fastest that this machine can run.
    #[must_use]
    pub fn best() -> Self {
        Self::available().pop().unwrap_or(Self::Portable)
    }
}
