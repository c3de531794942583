//! What counts as a finding besides a panic: memory. (Time is libFuzzer's, by `-timeout`.)
//!
//! Inputs have at most 16 KiB. Whatever they claim, no parser may have more bytes at one time than its target allows ([`Counted::allow`]).

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's memory, counted.
pub struct Counted {
    used: AtomicUsize,
    most: AtomicUsize,
}

impl Counted {
    /// Nothing in use.
    pub const fn new() -> Self {
        Self { used: AtomicUsize::new(0), most: AtomicUsize::new(usize::MAX) }
    }

    /// Sets the limit.
    pub fn allow(&self, bytes: usize) {
        self.most.store(bytes, Ordering::Relaxed);
    }

    fn take(&self, bytes: usize) {
        let used = self.used.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
        let most = self.most.load(Ordering::Relaxed);
        if used > most {
            // A message allocates, too.
            self.allow(usize::MAX);
            eprintln!("over-allocation: {bytes} bytes more, {used} in use, at most {most} allowed");
            std::process::abort();
        }
    }

    fn give(&self, bytes: usize) {
        self.used.fetch_sub(bytes, Ordering::Relaxed);
    }
}

// SAFETY: everything is passed on to the system's allocator as it came.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        self.take(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        self.take(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        self.give(layout.size());
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        self.take(size);
        self.give(layout.size());
        unsafe { System.realloc(pointer, layout, size) }
    }
}
