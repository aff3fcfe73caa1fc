//! How good a loop is, and how well its drive is known.

use crate::error::{Error, code};
use crate::memory::{object, write};
use crate::servo::calls::{Loop, at};
use crate::servo::edge::Body;

/// How good a loop is, and how well its drive is known: for who puts an axis into operation.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Delay of the valve in s, as the commissioning found it.
    pub delay: f32,
    /// 1 or -1: a positive command moves towards larger or smaller positions, as the commissioning
    /// found it.
    pub direction: i32,
    /// Bandwidth of the closed loop in rad/s.
    pub bandwidth: f32,
    /// Largest sensitivity of the closed loop; with the next three 0 while `has_margins` is false.
    pub sensitivity: f32,
    /// Phase margin in rad.
    pub phase_margin: f32,
    /// The delay in s that may come on top, infinite where any may.
    pub delay_margin: f32,
    /// Factor of the gain up to which the loop is stable, infinite where every one may be.
    pub gain_margin: f32,
    /// Standard deviation of `a1` of the verified model; with the next two infinite for a model of
    /// the commissioning or of the caller.
    pub a1_std: f32,
    /// Standard deviation of `a2`.
    pub a2_std: f32,
    /// Standard deviation of `b0`.
    pub b0_std: f32,
    /// Share of the movement that the last validated model explains in free simulation; negative
    /// where it is worse than a constant, minus infinity before there was one.
    pub r_squared: f32,
    /// Models that were accepted.
    pub accepted: u32,
    /// Models that were refused.
    pub refused: u32,
    /// Whether there are margins: not before there are gains, nor where the slowest ones have less
    /// than what is wanted.
    pub has_margins: bool,
}

impl From<&Body> for Quality {
    fn from(body: &Body) -> Self {
        let servo = &body.servo;
        let supervisor = servo.supervisor();
        let margins = servo.margins();
        let of = |value: Option<f32>| value.unwrap_or(0.0);
        let [a1_std, a2_std, b0_std] = supervisor.verified_std();
        let (accepted, refused) = supervisor.counts();
        Self {
            delay: servo.delay(),
            direction: if servo.sign() < 0.0 { -1 } else { 1 },
            bandwidth: servo.controller().bandwidth(),
            sensitivity: of(margins.map(|margins| margins.sensitivity)),
            phase_margin: of(margins.map(|margins| margins.phase)),
            delay_margin: of(margins.map(|margins| margins.delay)),
            gain_margin: of(margins.map(|margins| margins.gain)),
            a1_std,
            a2_std,
            b0_std,
            r_squared: supervisor.fit_report().r_squared(),
            accepted,
            refused,
            has_margins: margins.is_some(),
        }
    }
}

/// How good the loop is, and how well its drive is known.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_quality(servo: *const Loop, quality: *mut Quality) -> Error {
    // SAFETY: by the contract of the header.
    let found = unsafe { object(at(servo)) }.map(Quality::from);
    // SAFETY: by the contract of the header.
    code(found.and_then(|found| unsafe { write(quality, found) }))
}
