//! The core as it is compiled into this library, for programs of Rust that compare:
//! `cargo xtask capi --edge`.
//!
//! What a generic function becomes is decided anew in every crate that uses it; which loops are
//! unrolled differs.

use trendid::Servo;

/// [`Servo::theta`].
#[inline(never)]
pub fn theta(servo: &Servo<7>) -> [f32; 5] {
    servo.theta()
}
