//! Stack of the calls.

use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid::hardware::{PositionSensor, Valve};
use trendid_capi as c;
use trendid_example_support::board::{exit, line};
use trendid_example_support::drive::Drive;
use trendid_example_support::stack;

use crate::c_calls::{ORIGIN, done, loop_settings, settings};

/// Most stack of a call that is looked for, in bytes.
const PAINTED: usize = 64 * 1024;

/// A line with the stack of a call, which must succeed.
fn stack_of(name: &str, call: impl FnOnce() -> c::Error) {
    let mut error = c::Error::Other;
    let bytes = stack::peak_within(PAINTED, || error = call());
    done(error);
    // More than was painted is not known.
    if bytes >= PAINTED {
        exit(false);
    }
    line(format_args!("{name};{bytes}"));
}

/// Stack of what a program calls once, and of the read-out.
#[inline(never)]
pub(crate) fn measure() {
    // SAFETY: every pointer is to a value of this function, or NULL where the header allows it.
    unsafe {
        let settings = settings();
        let mut of_valve = settings;
        of_valve.dead_zone_max = 0.1;
        let mut handle = null_mut();
        let mut memory = MaybeUninit::<c::Servo3>::uninit();
        stack_of("servo3 init", || {
            c::trendid_servo3_init(memory.as_mut_ptr(), &settings, &mut handle, null_mut())
        });
        stack_of("servo3 update", || {
            c::trendid_identifier_update(handle, 0.1, 0.2, null_mut())
        });
        let mut found = MaybeUninit::<c::Estimate>::uninit();
        stack_of("servo3 estimate", || {
            c::trendid_identifier_estimate(handle, found.as_mut_ptr())
        });
        let mut memory = MaybeUninit::<c::ValveCoulomb3>::uninit();
        stack_of("valve_coulomb3 init", || {
            c::trendid_valve_coulomb3_init(memory.as_mut_ptr(), &of_valve, &mut handle, null_mut())
        });
        stack_of("valve_coulomb3 estimate", || {
            c::trendid_identifier_estimate(handle, found.as_mut_ptr())
        });
        let mut memory = MaybeUninit::<c::DelayBank>::uninit();
        stack_of("delay bank init", || {
            c::trendid_delay_bank_init(memory.as_mut_ptr(), &settings, null_mut())
        });
        let settings = loop_settings();
        let mut memory = MaybeUninit::<c::Loop>::uninit();
        stack_of("loop init", || {
            c::trendid_loop_init(memory.as_mut_ptr(), &settings, null_mut())
        });
        loop_stack(memory.as_mut_ptr());
    }
}

/// Stack of the samples of a loop: the most of a commissioning and of what comes behind it.
///
/// # Safety
/// The loop is initialised, and nobody else uses it.
unsafe fn loop_stack(servo: *mut c::Loop) {
    let mut report = MaybeUninit::<c::Report>::zeroed();
    let mut drive = Drive::new(ORIGIN);
    let mut valve = trendid_example_support::drive::SimulatedValve;
    let mut most = 0;
    // SAFETY: the loop is initialised; the report is one of this function, and zeros are one.
    unsafe {
        done(c::trendid_loop_commission(servo));
        for _ in 0..4000 {
            let Ok(code) = drive.counts();
            let bytes = stack::peak_within(PAINTED / 4, || {
                c::trendid_loop_update(servo, code, report.as_mut_ptr())
            });
            most = most.max(bytes);
            let _ = valve.drive(report.assume_init().command);
        }
    }
    if most >= PAINTED / 4 {
        exit(false);
    }
    line(format_args!("loop update;{most}"));
}
