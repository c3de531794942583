//! The memory that a process holds, and the most that it held, asked of the system: Linux remembers it, and resets it on request.

use std::fs;

/// Makes the system forget what the process held at most, so that [`peak_bytes`] is of what comes next.
pub fn forget_peak() {
    // "5" resets the peak (proc(5), clear_refs). Where that cannot be, the peak is that of the whole run, still a bound.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// The most bytes of memory that the process held since [`forget_peak`], shared libraries and what its allocator keeps included; none
/// where the system does not tell.
#[must_use]
pub fn peak_bytes() -> Option<u64> {
    status("VmHWM:")
}

/// Bytes of memory that the process holds now, as [`peak_bytes`] counts them.
#[must_use]
pub fn held_bytes() -> Option<u64> {
    status("VmRSS:")
}

/// A size that the system states of this process.
fn status(field: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(field))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn it_counts_what_is_used_for_a_moment() {
        const BYTES: usize = 48 << 20;
        let counted = || {
            forget_peak();
            let (held, before) = (held_bytes().unwrap(), peak_bytes().unwrap());
            drop(std::hint::black_box(vec![1u8; before as usize + BYTES]));
            held <= before && peak_bytes().unwrap() >= before + BYTES as u64
        };
        // Another test of this process may make the system forget in between.
        assert!((0..20).any(|_| counted()));
    }
}
