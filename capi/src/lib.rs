//! trendid from C: opaque objects in memory of the caller, no heap, no global state, errors as
//! codes.
//!
//! The names of this crate are those of `include/trendid.h`, which cbindgen makes from it;
//! docs/c.md shows how to use it.
//!
//! | module | what it does |
//! |---|---|
//! | error, detail | codes, their texts; which setting was refused |
//! | memory | the checks of every pointer, and nearly all `unsafe` |
//! | settings | settings of an identifier, what each kind takes of them, any structure |
//! | identifier | the objects that identify: one handle, eleven kinds of memory |
//! | bank | the delay of a drive |
//! | friction | the sign of the velocity, also of a drive that turns between samples |
//! | servo | the position loop, and its model as a record |
//! | sizes | bytes of the objects |
//! | compiled | the core as this library has it, for comparisons in Rust |
//!
//! An identifier is a handle on memory of some kind; what the handle can do stands in a table that
//! the initialisation of this kind leaves in the object. So a program links the code of the kinds
//! that it initialises and of no other.

#![no_std]
// The contract of every pointer is one and the same, and stands at the head of the header.
#![allow(clippy::missing_safety_doc)]

#[cfg(test)]
extern crate std;

mod bank;
pub mod compiled;
mod detail;
mod error;
mod friction;
mod identifier;
mod memory;
mod servo;
mod settings;
mod sizes;

pub use bank::*;
pub use detail::*;
pub use error::*;
pub use friction::*;
pub use identifier::*;
pub use servo::*;
pub use settings::*;
pub use sizes::*;

use core::ffi::c_char;

/// Version of this interface: another number, another layout of the types.
pub const ABI_VERSION: u32 = 2;

/// The version of the interface that the library was built with, to be compared with
/// `TRENDID_ABI_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_abi_version() -> u32 {
    ABI_VERSION
}

/// The version of the library, in static memory.
#[unsafe(no_mangle)]
pub extern "C" fn trendid_version() -> *const c_char {
    const TEXT: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    TEXT.as_ptr().cast()
}

/// An archive without the standard library must have one; nothing that is exported reaches it.
#[cfg(all(feature = "archive", panic = "abort", not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Named by the tables of the precompiled core library on hosts; without unwinding nothing calls
/// it.
#[cfg(all(
    feature = "archive",
    panic = "abort",
    not(target_os = "none"),
    not(test)
))]
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}
