//! Which instruction set a kernel is compiled for. One that a machine may lack comes with a token, which detection alone gives:
//! who holds it may run the kernel.

/// Proof that this machine has AVX2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx2(());

/// Proof that this machine has AVX-512 F, BW, DQ and VL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx512(());

/// Proof that this machine has, besides, VNNI and VBMI2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx512Vnni(());

/// Proof that this machine has, besides, AMX with products of bytes, and that this process may use its tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Amx(());

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
    /// AVX-512 of the first machines that had it.
    Avx512(Avx512),
    /// AVX-512 with sums of products, and words packed by a mask.
    Avx512Vnni(Avx512Vnni),
    /// Products of tiles of bytes, with AVX-512 for all else.
    Amx(Amx),
}

impl Isa {
    /// Those that this machine can run, slowest first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        Self::detected().collect()
    }

    /// The fastest that this machine can run.
    #[must_use]
    pub fn best() -> Self {
        Self::detected().last().unwrap_or(Self::Portable)
    }

    #[cfg(target_arch = "x86_64")]
    fn detected() -> impl Iterator<Item = Self> {
        let avx2 = is_x86_feature_detected!("avx2").then(|| Self::Avx2(Avx2(())));
        let avx512 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        let vnni =
            avx512 && is_x86_feature_detected!("avx512vnni") && is_x86_feature_detected!("avx512vbmi2");
        let avx512 = if avx512 { Some(Self::Avx512(Avx512(()))) } else { None };
        let amx = if vnni && may_use_tiles() { Some(Self::Amx(Amx(()))) } else { None };
        let vnni = if vnni { Some(Self::Avx512Vnni(Avx512Vnni(()))) } else { None };
        [Some(Self::Portable), avx2, avx512, vnni, amx].into_iter().flatten()
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn detected() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Portable)
    }
}

/// Whether the processor has AMX with products of bytes, and the operating system lets this process use it, for which it must be asked once.
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
fn may_use_tiles() -> bool {
    use std::arch::{asm, x86_64::__cpuid_count};
    use std::sync::LazyLock;
    // CPUID 7: EDX says AMX-TILE and AMX-INT8. Linux' arch_prctl with ARCH_REQ_XCOMP_PERM asks for the tiles' state.
    const TILE_INT8: u32 = 1 << 24 | 1 << 25;
    const ARCH_PRCTL: i64 = 158;
    const ARCH_REQ_XCOMP_PERM: i64 = 0x1023;
    const TILE_DATA: i64 = 18;
    static ASKED: LazyLock<bool> = LazyLock::new(|| {
        if __cpuid_count(7, 0).edx & TILE_INT8 != TILE_INT8 {
            return false;
        }
        let mut result = ARCH_PRCTL;
        // SAFETY: this system call takes two numbers, and changes nothing of this program's.
        unsafe {
            asm!(
                "syscall",
                inout("rax") result,
                in("rdi") ARCH_REQ_XCOMP_PERM,
                in("rsi") TILE_DATA,
                out("rcx") _,
                out("r11") _,
                options(nostack),
            );
        }
        result == 0
    });
    *ASKED
}

#[cfg(all(target_arch = "x86_64", not(target_os = "linux")))]
const fn may_use_tiles() -> bool {
    false
}

/// Defines a function whose body, plain Rust, is compiled once for every instruction set.
macro_rules! for_each_isa {
    ($(#[$doc:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),*) -> $out:ty $body:block) => {
        $(#[$doc])*
        $vis fn $name(isa: $crate::fast::isa::Isa, $($arg: $type),*) -> $out {
            use $crate::fast::isa::Isa;

            #[inline(always)]
            fn body($($arg: $type),*) -> $out $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($arg: $type),*) -> $out { body($($arg),*) }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
            fn avx512($($arg: $type),*) -> $out { body($($arg),*) }

            match isa {
                Isa::Portable => body($($arg),*),
                // SAFETY: the token proves that this machine has these instructions.
                #[cfg(target_arch = "x86_64")]
                Isa::Avx2(_) => unsafe { avx2($($arg),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                Isa::Avx512(_) | Isa::Avx512Vnni(_) | Isa::Amx(_) => unsafe { avx512($($arg),*) },
                #[cfg(not(target_arch = "x86_64"))]
                _ => body($($arg),*),
            }
        }
    };
}
pub(crate) use for_each_isa;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_rust_runs_everywhere_and_the_best_comes_last() {
        let available = Isa::available();
        assert_eq!(available[0], Isa::Portable);
        assert_eq!(available.last(), Some(&Isa::best()));
        let is_new = |at: usize| !available[..at].contains(&available[at]);
        assert!((1..available.len()).all(is_new));
        #[cfg(target_arch = "x86_64")]
        assert_eq!(available.contains(&Isa::Avx2(Avx2(()))), is_x86_feature_detected!("avx2"));
    }
}
