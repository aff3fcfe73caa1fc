//! The machine of the servo examples: its settings, what it is asked to do, and a hash of what it
//! did.
//!
//! The loop runs in a bare interrupt (`examples/servo`), in RTIC, in Embassy and on the host. With
//! the simulated drive the four make the same requests in the same samples, so that their hashes
//! must agree to the last bit.

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::store::{Identity, Record};
use trendid::servo::{Config, Error, Report, ServoLoop, State, Travel};

use crate::hash::Hash;
use crate::request::{Action, Request};

/// Units of the encoder: 5 um per count.
const MM_PER_COUNT: f32 = 0.005;

/// Code of the transducer at the begin of the travel, read once when the machine was built.
pub const ORIGIN: i32 = 8_000_000;

/// The machine: 400 mm of travel, a valve and a cylinder of about 20 rad/s.
const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};
/// The time slot in s.
const SAMPLE_TIME: f32 = 1e-3;

const BANDWIDTH: f32 = 20.0;

/// Time in s from the command to the flow: none in the simulated drive, 2 ms with a spool valve of
/// 100 Hz. The commissioning finds it: 2 ms that are not there change a1 and a2 by less than 1 %,
/// the dead zone by 3 %.
const DELAY: f32 = 0.0;

/// Time in s of excitation before a model is tried, with room above the default: after 0.2 s a1 is
/// 6 % and the dead zone 14 % too small, from the default of 0.3 s on they are within 1 and 7 %.
const EXCITE_TIME: f32 = 0.5;

/// The machine: its model is of no use to another one. A serial number, where there is one.
const PLANT: u32 = 1;

/// Targets of the moves in mm, and the samples between them.
const TARGETS: [f32; 2] = [120.0, 280.0];
const DWELL: u64 = 1500;

/// Sample in which the machine is asked to run, once it was seen to rest.
pub const BEGIN: u64 = 501;

/// Samples of which the hash is compared.
pub const TRACED: u64 = 4000;

/// From codes to millimetres.
pub const AXIS: Axis = Axis {
    scale: Scale::new(MM_PER_COUNT).unwrap(),
    reference: ORIGIN,
};

/// The settings of this machine.
#[must_use]
pub fn config() -> Config {
    let mut config = Config::new(SAMPLE_TIME, BANDWIDTH, TRAVEL);
    config.delay = DELAY;
    config.supervision.excite_time = EXCITE_TIME;
    config
}

/// What a stored model of this machine must have been found under.
#[must_use]
pub fn identity(config: &Config) -> Identity {
    Identity::new(PLANT, config)
}

/// A verified model with the settings that it was found under, which may be others than those of
/// the next start.
#[derive(Clone, Debug, PartialEq)]
pub struct Verified {
    /// The machine and its settings.
    pub identity: Identity,
    /// The model and its conditions.
    pub record: Record,
}

impl Verified {
    /// Whether the next start of this program takes it.
    #[must_use]
    pub fn is_of_the_program(&self) -> bool {
        self.identity == identity(&config())
    }

    /// What a loop of these settings has verified; `None` before there is a model.
    #[must_use]
    pub fn of<S: PositionSensor, V: Valve>(
        servo: &ServoLoop<S, V>,
        config: &Config,
    ) -> Option<Self> {
        Some(Self {
            identity: identity(config),
            record: servo.record()?,
        })
    }
}

/// The control loop of this machine, idle.
///
/// # Errors
/// Those of [`ServoLoop::try_new`]; with the settings above there is none.
pub fn servo_loop<S: PositionSensor, V: Valve>(
    sensor: S,
    valve: V,
) -> Result<ServoLoop<S, V>, Error> {
    ServoLoop::try_new(&config(), AXIS, sensor, valve)
}

/// Whether a loop moves the axis or is about to: it may wait for the rest that it begins with,
/// which the state that it `reported` last says alone.
#[must_use]
pub fn moves<S: PositionSensor, V: Valve>(servo: &ServoLoop<S, V>, reported: State) -> bool {
    let states = [servo.supervisor().state(), reported];
    states
        .iter()
        .any(|state| state.is_commissioning() || state.is_controlling())
}

/// The next move, when one is due in sample `tick`.
#[must_use]
pub fn target(tick: u64) -> Option<f32> {
    tick.is_multiple_of(DWELL)
        .then(|| TARGETS[(tick / DWELL) as usize % TARGETS.len()])
}

/// What a person, or the control above, asks for in sample `tick`.
#[must_use]
pub fn plan(tick: u64) -> Option<Request> {
    let action = if tick == BEGIN {
        Some(Action::Commission)
    } else {
        target(tick).map(Action::MoveTo)
    };
    action.map(|action| Request { tick, action })
}

/// Hash of every position, setpoint and command of a run, and of whether the loop controlled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Trace(Hash);

impl Trace {
    /// The hash of no sample.
    #[must_use]
    pub const fn new() -> Self {
        Self(Hash::new())
    }

    /// Takes what one sample did.
    pub fn take(&mut self, report: &Report) {
        let state = report.state;
        let phase = u32::from(state.is_commissioning()) + 2 * u32::from(state.is_controlling());
        self.0.take_bits(phase);
        self.0.take(report.position);
        self.0.take(report.setpoint.position);
        self.0.take(report.command);
    }

    /// The hash.
    #[must_use]
    pub const fn value(&self) -> u64 {
        self.0.value()
    }
}

/// The machine at work: the loop, the number of its sample, and the hash of the first [`TRACED`]
/// samples.
#[derive(Debug)]
pub struct Machine<S, V> {
    /// The loop.
    pub servo: ServoLoop<S, V>,
    tick: u64,
    trace: Trace,
}

impl<S: PositionSensor, V: Valve> Machine<S, V> {
    /// The machine before its first sample, idle.
    ///
    /// # Errors
    /// Those of [`servo_loop`].
    pub fn try_new(sensor: S, valve: V) -> Result<Self, Error> {
        Ok(Self {
            servo: servo_loop(sensor, valve)?,
            tick: 0,
            trace: Trace::new(),
        })
    }

    /// Number of the sample that comes next.
    #[must_use]
    pub const fn next_tick(&self) -> u64 {
        self.tick + 1
    }

    /// One sample, after what was asked for it.
    pub fn update(&mut self, action: Option<Action>) -> Report {
        match action {
            Some(Action::Commission) => self.servo.commission(),
            Some(Action::MoveTo(target)) if self.servo.supervisor().state().is_controlling() => {
                // A target that is not finite is refused, and the reference goes on as before.
                let _ = self.servo.move_to(target);
            }
            Some(Action::MoveTo(_)) | None => {}
            Some(Action::Abort) => self.servo.abort(),
        }
        let report = self.servo.update();
        self.tick += 1;
        if self.tick <= TRACED {
            self.trace.take(&report);
        }
        report
    }

    /// The hash of what it did.
    #[must_use]
    pub const fn trace(&self) -> Trace {
        self.trace
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::sync::{Mutex, PoisonError};

    use trendid::servo::store::{Record, Refused};

    use super::*;
    use crate::drive::{Drive, SimulatedValve};

    /// Drive and valve of a process meet in one place: one axis at a time.
    static ONE_AXIS: Mutex<()> = Mutex::new(());

    /// Over the wire the delay may be set; the next start has that of the program again.
    #[test]
    fn a_model_of_another_delay_is_none_of_the_next_start() {
        let _alone = ONE_AXIS.lock().unwrap_or_else(PoisonError::into_inner);
        for delay in [DELAY, 0.002] {
            let mut settings = config();
            settings.delay = delay;
            let drive = Drive::new(ORIGIN);
            let mut servo = ServoLoop::try_new(&settings, AXIS, drive, SimulatedValve).unwrap();
            assert_eq!(Verified::of(&servo, &settings), None);
            servo.commission();
            for _ in 0..2000 {
                let _ = servo.update();
            }
            let verified = Verified::of(&servo, &settings).unwrap();
            assert_eq!(verified.is_of_the_program(), delay == DELAY);
            let Verified {
                identity: of,
                record,
            } = verified;
            let read = Record::from_bytes(&record.to_bytes(&of, 0), &identity(&config()));
            if delay == DELAY {
                assert_eq!(read, Ok((record, 0)));
            } else {
                assert!(matches!(read, Err(Refused::Settings { .. })), "{read:?}");
            }
        }
    }

    /// Stopped in motion and commissioned at once: the axis comes to rest first, and a person who
    /// presses the button meanwhile stops that.
    #[test]
    fn an_axis_that_comes_to_rest_for_its_commissioning_moves() {
        let _alone = ONE_AXIS.lock().unwrap_or_else(PoisonError::into_inner);
        let mut servo = servo_loop(Drive::new(ORIGIN), SimulatedValve).unwrap();
        let mut state = State::Idle;
        let mut run = |servo: &mut ServoLoop<_, _>, samples: u32, moving: bool| {
            for sample in 0..samples {
                state = servo.update().state;
                assert_eq!(moves(servo, state), moving, "{sample}: {state:?}");
            }
            servo.supervisor().state()
        };
        assert_eq!(run(&mut servo, 10, false), State::Idle);
        servo.commission();
        assert!(run(&mut servo, 2000, true).is_controlling());
        servo.move_to(350.0).unwrap();
        assert!(run(&mut servo, 100, true).is_controlling());
        servo.abort();
        assert_eq!(run(&mut servo, 2, false), State::Idle);
        servo.commission();
        // The supervisor has not begun yet.
        assert_eq!(run(&mut servo, 20, true), State::Idle);
        servo.abort();
        assert_eq!(run(&mut servo, 3000, false), State::Idle);
    }
}
