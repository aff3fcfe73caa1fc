//! The C interface as its callers have it.

use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid_capi as c;
use trendid_example_support::board::{exit, line};

/// The functions of C, as pointers that the optimiser must not see through.
pub(crate) type Update =
    unsafe extern "C" fn(*mut c::Identifier, f32, f32, *mut c::Outcome) -> c::Error;
pub(crate) type Theta = unsafe extern "C" fn(*const c::Identifier, *mut f32, usize) -> c::Error;
pub(crate) type Estimate = unsafe extern "C" fn(*const c::Identifier, *mut c::Estimate) -> c::Error;
pub(crate) type LoopUpdate = unsafe extern "C" fn(*mut c::Loop, i32, *mut c::Report) -> c::Error;

/// Ends the image where a call of C fails.
pub(crate) fn done(error: c::Error) {
    if error != c::Error::Ok {
        line(format_args!("{error:?}"));
        exit(false);
    }
}

/// Code of the middle of the axis.
pub(crate) const ORIGIN: i32 = 8_000_000;

/// Settings of an identifier for the record.
pub(crate) fn settings() -> c::Settings {
    let mut settings = MaybeUninit::uninit();
    // SAFETY: a pointer to a value of this function, which the call fills.
    unsafe {
        done(c::trendid_settings_init(
            settings.as_mut_ptr(),
            0.001,
            20.0,
            1.0,
            50.0,
        ));
        settings.assume_init()
    }
}

/// Settings of a loop for the simulated drive.
pub(crate) fn loop_settings() -> c::LoopSettings {
    let mut settings = MaybeUninit::uninit();
    // SAFETY: a pointer to a value of this function, which the call fills.
    unsafe {
        done(c::trendid_loop_settings_init(
            settings.as_mut_ptr(),
            0.001,
            0.0,
            400.0,
            0.005,
            ORIGIN,
        ));
        settings.assume_init()
    }
}

/// An identifier of order 3 in this memory.
pub(crate) fn servo3(
    memory: &mut MaybeUninit<c::Servo3>,
    settings: &c::Settings,
) -> *mut c::Identifier {
    let mut handle = null_mut();
    // SAFETY: every pointer is to a value, or NULL where the header allows it.
    done(unsafe { c::trendid_servo3_init(memory.as_mut_ptr(), settings, &mut handle, null_mut()) });
    handle
}
