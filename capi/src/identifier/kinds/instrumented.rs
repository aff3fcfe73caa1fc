//! A command as it comes, with instruments beside the recursion: integrating drives of order 2 and
//! 3.
//!
//! One after another, as those of `plain`.

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::Identifier;
use crate::identifier::body::begin;
use crate::identifier::instrumented::{SERVO2, SERVO3};
use crate::identifier::kinds::{OfInstrumented2, OfInstrumented3, of};
use crate::settings::Settings;

/// Words of 8 bytes of a `trendid_instrumented2`.
pub const INSTRUMENTED2_WORDS: usize = 424;

/// Memory of an identifier as `trendid_servo2` with instruments beside its recursion: without the
/// bias that drift and coloured noise of the position make, and with standard deviations that
/// assume no noise model.
///
/// theta = (a1, b0, constant, initial state); inputs: u. Every read-out costs as much as
/// `trendid_identifier_estimate`; a warm start, a retune and a nominal estimate are not offered.
#[repr(C)]
pub struct Instrumented2 {
    words: [u64; INSTRUMENTED2_WORDS],
}

/// Makes an identifier of the kind `trendid_instrumented2`; `detail`, if not NULL, says which
/// setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_instrumented2_init(
    memory: *mut Instrumented2,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfInstrumented2| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, SERVO2)
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}

/// Words of 8 bytes of a `trendid_instrumented3`.
pub const INSTRUMENTED3_WORDS: usize = 548;

/// Memory of an identifier as `trendid_servo3` with instruments, as `trendid_instrumented2`.
///
/// theta = (a1, a2, b0, constant, initial state); inputs: u.
#[repr(C)]
pub struct Instrumented3 {
    words: [u64; INSTRUMENTED3_WORDS],
}

/// Makes an identifier of the kind `trendid_instrumented3`; `detail`, if not NULL, says which
/// setting was refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_instrumented3_init(
    memory: *mut Instrumented3,
    settings: *const Settings,
    identifier: *mut *mut Identifier,
    detail: *mut Detail,
) -> Error {
    let configure = |kind: &mut OfInstrumented3| {
        // SAFETY: by the contract of the header.
        let settings = unsafe { of(settings) }?;
        kind.configure(settings, SERVO3)
    };
    // SAFETY: by the contract of the header.
    unsafe { begin(memory, configure, identifier, detail) }
}
