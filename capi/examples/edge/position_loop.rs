//! A sample of the loop.

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, ServoLoop, Travel};
use trendid_capi as c;
use trendid_example_support::clock::Clock;
use trendid_example_support::drive::Drive;

use crate::c_calls::{LoopUpdate, ORIGIN, done, loop_settings};
use crate::count::row;

/// The loop of Rust with the same edge: a code that is put in, a command that is taken as it is.
struct Code(i32);

impl PositionSensor for Code {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        Ok(self.0)
    }
}

struct Still;

impl Valve for Still {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        Ok(command)
    }
}

type Loop = ServoLoop<Code, Still>;

#[inline(never)]
fn rust_loop(servo: &mut Loop, code: i32) -> servo::Report {
    servo.sensor_mut().0 = code;
    servo.update()
}

#[inline(never)]
pub(crate) fn count(clock: &Clock, idle: f32) -> Result<(), servo::Error> {
    let mut memory = MaybeUninit::<c::Loop>::uninit();
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let config = servo::Config::new(0.001, 20.0, travel);
    let axis = Axis {
        scale: const { Scale::new(0.005).unwrap() },
        reference: ORIGIN,
    };
    let mut native = Loop::try_new(&config, axis, Code(0), Still)?;
    native.commission();
    // SAFETY: every pointer is to a value of this function.
    unsafe {
        let mut settings = loop_settings();
        settings.bandwidth = 20.0;
        let memory = memory.as_mut_ptr();
        done(c::trendid_loop_init(memory, &settings, null_mut()));
        done(c::trendid_loop_commission(memory));
        let update = black_box(c::trendid_loop_update as LoopUpdate);
        let mut report = MaybeUninit::<c::Report>::zeroed();
        let mut drive = Drive::new(ORIGIN);
        let mut valve = trendid_example_support::drive::SimulatedValve;
        row(clock, idle, "loop update", |k, _, _| {
            let Ok(code) = drive.counts();
            if k % 1000 == 999 {
                let target = if k % 2000 == 999 { 250.0 } else { 150.0 };
                // Both refuse while the commissioning lasts.
                if native.move_to(target).is_ok() {
                    done(c::trendid_loop_move_to(memory, target, null_mut()));
                }
            }
            let rust = clock.ticks(|| rust_loop(&mut native, code));
            let edge = clock.ticks(|| update(memory, code, report.as_mut_ptr()));
            let _ = valve.drive(report.assume_init().command);
            [rust, edge]
        });
    }
    Ok(())
}
