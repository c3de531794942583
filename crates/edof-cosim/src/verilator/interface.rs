//! The C functions of a compiled model.

use std::ffi::{c_char, c_int};

/// An instance of the model, on the C++ side.
pub enum Instance {}

/// The functions of `shim.cpp`, by the names that they have there. Valid while `library` is loaded.
pub struct Interface {
    pub message: unsafe extern "C" fn() -> *const c_char,
    pub create: unsafe extern "C" fn(i32, i32, *const c_char) -> *mut Instance,
    pub destroy: unsafe extern "C" fn(*mut Instance),
    pub poke: unsafe extern "C" fn(*mut Instance, u32, *const u32),
    pub peek: unsafe extern "C" fn(*mut Instance, u32, *mut u32),
    pub apply: unsafe extern "C" fn(*mut Instance, *const u32),
    pub sample: unsafe extern "C" fn(*mut Instance, *mut u32),
    pub settle: unsafe extern "C" fn(*mut Instance) -> c_int,
    pub tick: unsafe extern "C" fn(*mut Instance) -> c_int,
    pub rise: unsafe extern "C" fn(*mut Instance, *const u32, usize) -> c_int,
    pub run: unsafe extern "C" fn(*mut Instance, usize, *const u32, *mut u32) -> c_int,
    pub cycle: unsafe extern "C" fn(*const Instance) -> u64,
    pub trace: unsafe extern "C" fn(*mut Instance, *const c_char, u64, u64) -> c_int,
    pub end_trace: unsafe extern "C" fn(*mut Instance),
    pub library: libloading::Library,
}

impl Interface {
    /// # Safety
    /// The library was compiled from `shim.cpp`.
    pub unsafe fn of(library: libloading::Library) -> Result<Self, libloading::Error> {
        macro_rules! symbol {
            ($name:literal) => {
                // SAFETY: the caller vouches for the library, so the symbol has the type of the field it goes to.
                unsafe { *library.get($name)? }
            };
        }
        Ok(Self {
            message: symbol!(b"edof_message\0"),
            create: symbol!(b"edof_create\0"),
            destroy: symbol!(b"edof_destroy\0"),
            poke: symbol!(b"edof_poke\0"),
            peek: symbol!(b"edof_peek\0"),
            apply: symbol!(b"edof_apply\0"),
            sample: symbol!(b"edof_sample\0"),
            settle: symbol!(b"edof_settle\0"),
            tick: symbol!(b"edof_tick\0"),
            rise: symbol!(b"edof_rise\0"),
            run: symbol!(b"edof_run\0"),
            cycle: symbol!(b"edof_cycle\0"),
            trace: symbol!(b"edof_trace\0"),
            end_trace: symbol!(b"edof_end_trace\0"),
            library,
        })
    }
}
