//! Identifiers: a sample, the read-out.

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid::{Outcome, Servo, ValveServo};
use trendid_capi as c;
use trendid_example_support::clock::Clock;

use crate::c_calls::{Estimate, Theta, Update, done, servo3, settings};
use crate::count::row;

#[inline(never)]
fn rust_servo(servo: &mut Servo<7>, u: f32, y: f32) -> Outcome {
    servo.update(u, y)
}

#[inline(never)]
fn rust_valve(servo: &mut ValveServo<7>, u: f32, y: f32) -> Outcome {
    servo.update(u, y)
}

#[inline(never)]
fn rust_theta(servo: &Servo<7>) -> [f32; 5] {
    servo.theta()
}

/// What `trendid_identifier_estimate` gives.
#[inline(never)]
fn rust_estimate(servo: &Servo<7>) -> impl Sized {
    let found = servo.estimate();
    (
        found.theta(),
        found.std(),
        found.transfer_function(),
        found.physical(),
        found.physical_std(),
    )
}

#[inline(never)]
fn linear(clock: &Clock, idle: f32) -> Result<(), trendid::ConfigError> {
    // SAFETY: every pointer is to a value of this function, or NULL where the header allows it.
    unsafe {
        let settings = settings();
        let mut memory = MaybeUninit::uninit();
        let handle = servo3(&mut memory, &settings);
        let mut native = Servo::<7>::with_delay(0.001, 20.0, 1.0, 50.0, 0)?;
        let update = black_box(c::trendid_identifier_update as Update);
        let mut outcome = c::Outcome::from(Outcome::WarmingUp { remaining: 0 });
        row(clock, idle, "servo3 update", |_, u, y| {
            let rust = clock.ticks(|| rust_servo(&mut native, u, y));
            let edge = clock.ticks(|| update(handle, u, y, &raw mut outcome));
            [rust, edge]
        });
        let theta = black_box(c::trendid_identifier_theta as Theta);
        let mut found = [0.0_f32; 5];
        row(clock, idle, "servo3 theta", |_, u, y| {
            let _ = rust_servo(&mut native, u, y);
            let _ = update(handle, u, y, &raw mut outcome);
            let rust = clock.ticks(|| c::compiled::theta(&native));
            let edge = clock.ticks(|| theta(handle, found.as_mut_ptr(), 5));
            [rust, edge]
        });
        row(clock, idle, "servo3 theta, own copy", |_, u, y| {
            let _ = rust_servo(&mut native, u, y);
            let _ = update(handle, u, y, &raw mut outcome);
            let rust = clock.ticks(|| rust_theta(&native));
            let edge = clock.ticks(|| theta(handle, found.as_mut_ptr(), 5));
            [rust, edge]
        });
        let estimate = black_box(c::trendid_identifier_estimate as Estimate);
        let mut found = MaybeUninit::<c::Estimate>::uninit();
        row(clock, idle, "servo3 estimate", |_, u, y| {
            let _ = rust_servo(&mut native, u, y);
            let _ = update(handle, u, y, &raw mut outcome);
            let rust = clock.ticks(|| rust_estimate(&native));
            let edge = clock.ticks(|| estimate(handle, found.as_mut_ptr()));
            [rust, edge]
        });
    }
    Ok(())
}

#[inline(never)]
fn valve(clock: &Clock, idle: f32) -> Result<(), trendid::ConfigError> {
    // SAFETY: every pointer is to a value of this function, or NULL where the header allows it.
    unsafe {
        let mut settings = settings();
        let update = black_box(c::trendid_identifier_update as Update);
        let mut outcome = c::Outcome::from(Outcome::WarmingUp { remaining: 0 });
        settings.memory = 0.7;
        settings.dead_zone_max = 0.1;
        let mut memory = MaybeUninit::<c::Valve3>::uninit();
        let mut handle = null_mut();
        done(c::trendid_valve3_init(
            memory.as_mut_ptr(),
            &settings,
            &mut handle,
            null_mut(),
        ));
        let mut config = trendid::Config::new(trendid::Structure::SERVO, 20.0, [1.0; 2], 50.0);
        config.memory = Some(0.7);
        let trends = trendid::trends::FilteredTrends::for_bandwidth(
            trendid::trends::Scheme::Tustin,
            0.001,
            20.0,
        )?;
        let zone = trendid::inputs::DeadZone::new(0.0, 0.1, 300);
        let mut native = ValveServo::<7>::try_new(&config, trends, zone)?;
        row(clock, idle, "valve3 update", |_, u, y| {
            let rust = clock.ticks(|| rust_valve(&mut native, u, y));
            let edge = clock.ticks(|| update(handle, u, y, &raw mut outcome));
            [rust, edge]
        });
    }
    Ok(())
}

/// The rows.
pub(crate) fn count(clock: &Clock, idle: f32) -> Result<(), trendid::ConfigError> {
    linear(clock, idle)?;
    valve(clock, idle)
}
