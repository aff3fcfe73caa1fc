//! What a loop tells in numbers: a sample, what it has learned, its counters.
//!
//! The order of the fields is part of the protocol; a change is another
//! [`VERSION`](crate::VERSION).

use serde::{Deserialize, Serialize};
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Reason, Report, ServoLoop, State};

use crate::code;

/// One sample of the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Number of the sample since the start; wraps.
    pub tick: u32,
    /// [`trendid::servo::State::code`].
    pub state: u8,
    /// Reason of the state in the order of [`trendid::servo::Reason`], or [`code::NO_REASON`].
    pub reason: u8,
    /// Whether a model reached the controller in this sample.
    pub retuned: bool,
    /// Measured position.
    pub position: f32,
    /// Reference and its velocity.
    pub setpoint: [f32; 2],
    /// Observed velocity.
    pub velocity: f32,
    /// Command of the valve, -1 to 1.
    pub command: f32,
    /// Innovation of the identifier.
    pub innovation: Option<f32>,
}

impl Sample {
    /// What `servo` did in the sample of `report`.
    #[must_use]
    pub fn of<S: PositionSensor, V: Valve>(
        tick: u32,
        report: &Report,
        servo: &ServoLoop<S, V>,
    ) -> Self {
        Self {
            tick,
            state: report.state.code(),
            reason: code::of(report.state.reason()),
            retuned: report.retuned,
            position: finite(report.position),
            setpoint: [
                finite(report.setpoint.position),
                finite(report.setpoint.velocity),
            ],
            velocity: finite(servo.controller().motion().velocity),
            command: finite(report.command),
            innovation: report.innovation.filter(|e| e.is_finite()),
        }
    }

    /// A machine that a fault has stopped stands behind a closed valve at this position: the loop
    /// is at rest, and in none of the states in which it moves the axis.
    #[must_use]
    pub fn stopped(tick: u32, position: f32, before: &Self) -> Self {
        let failed = State::Failed(Reason::Aborted).code();
        let [state, reason] = if before.state == failed {
            [failed, before.reason]
        } else {
            [State::Idle.code(), code::NO_REASON]
        };
        Self {
            tick,
            state,
            reason,
            position: finite(position),
            setpoint: [finite(position), 0.0],
            ..Self::default()
        }
    }
}

/// What the loop has learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Learned {
    /// Number of the sample.
    pub tick: u32,
    /// Estimated a1, a2, b0.
    pub theta: [f32; 3],
    /// Their covariance: 11, 22, 33, 12, 13, 23; `None` where nothing is known yet.
    pub covariance: Option<[f32; 6]>,
    /// The model in the controller: a1, a2, b0, dead zone, offset, friction.
    pub model: [f32; 6],
    /// Standard deviation that the identifier expects of its innovation.
    pub expected: Option<f32>,
    /// Models accepted and refused so far.
    pub counts: [u32; 2],
    /// Why the last one was refused, or [`code::NO_REASON`].
    pub refusal: u8,
    /// Sign of the valve.
    pub reversed: bool,
    /// Delay of the valve in s.
    pub delay: f32,
    /// Factor on the bandwidth.
    pub derating: f32,
    /// Gain margin, phase margin in degrees, delay margin in s, largest sensitivity; `None` where
    /// they were not computed.
    pub margins: Option<[f32; 4]>,
}

impl Learned {
    /// What `servo` knows after the sample of `report`. Cost: a reading of the covariance, some
    /// thousand instructions.
    #[must_use]
    pub fn of<S: PositionSensor, V: Valve>(
        tick: u32,
        report: &Report,
        servo: &ServoLoop<S, V>,
    ) -> Self {
        let found = servo.identifier().recursion();
        let ([a1, a2, b0, ..], p) = (found.theta(), found.covariance());
        let covariance = [p[0][0], p[1][1], p[2][2], p[0][1], p[0][2], p[1][2]];
        let model = servo.controller().model();
        let (accepted, refused) = servo.supervisor().counts();
        Self {
            tick,
            theta: [a1, a2, b0].map(finite),
            covariance: covariance
                .iter()
                .all(|p| p.is_finite())
                .then_some(covariance),
            model: model.fields().map(finite),
            expected: servo.identifier().noise_std().filter(|s| s.is_finite()),
            counts: [accepted, refused],
            refusal: code::of(servo.supervisor().refusal()),
            reversed: servo.sign() < 0.0,
            delay: finite(servo.delay()),
            derating: finite(report.faults.derating),
            margins: servo.margins().map(|m| {
                let degrees = m.phase.to_degrees();
                [m.gain, degrees, m.delay, m.sensitivity].map(bounded)
            }),
        }
    }
}

/// Counters since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Health {
    /// Number of the sample.
    pub tick: u32,
    /// Readings that failed.
    pub failed_readings: u32,
    /// Readings that the axis cannot have reached.
    pub implausible_readings: u32,
    /// Samples at the full command.
    pub saturated_samples: u32,
    /// Oscillations at rest that were noticed.
    pub oscillations: u32,
    /// Faults that stopped the axis; a commissioning that gives up is none.
    pub stops: u32,
    /// Departures from where the axis was while its reference rests.
    pub moves_at_rest: u32,
    /// Slots that were not done in time.
    pub overruns: u32,
    /// Longest slot in us.
    pub longest_us: u32,
    /// Samples that did not fit on the line.
    pub dropped: u32,
    /// Events that were lost because nobody acknowledged and [`EVENTS`](super::EVENTS) waited
    /// already.
    pub events_lost: u32,
    /// Damaged frames that the target received.
    pub corrupt: u32,
}

impl Health {
    /// The counters of the loop; what the slot and the line count is filled in by their owners.
    #[must_use]
    pub fn of(tick: u32, report: &Report) -> Self {
        let faults = report.faults;
        Self {
            tick,
            failed_readings: faults.failed_readings,
            implausible_readings: faults.implausible_readings,
            saturated_samples: faults.saturated_samples,
            oscillations: faults.oscillations,
            stops: faults.stops,
            moves_at_rest: faults.moves_at_rest,
            ..Self::default()
        }
    }
}

/// A margin for the line: the largest number in the place of an infinite one.
fn bounded(margin: f32) -> f32 {
    if margin.is_nan() {
        0.0
    } else {
        margin.min(f32::MAX)
    }
}

/// A number for the line: zero in the place of what is not finite.
fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}
