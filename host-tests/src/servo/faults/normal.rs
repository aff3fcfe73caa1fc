//! Work without a fault, in which an alarm is a false one.

use rand::RngExt;
use trendid::servo::{Model, Reason, State};

use crate::servo::faults::machine::Machine;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::family::Family;
use crate::servo::population::range::{Purpose, stream};
use crate::servo::population::sequence::amplitude;

/// Largest error in motion, and at rest, over the travel, with which an axis counts as controlled.
const IN_MOTION: f64 = 0.05;
const AT_REST: f64 = 0.01;

/// What came of normal work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalRun {
    /// The axis.
    pub seed: u64,
    /// Time that was worked \[s\].
    pub worked_s: f64,
    /// Why the loop stopped, and when \[s\].
    pub stopped: Option<(Reason, f64)>,
    /// Largest true error before that, over the travel.
    pub worst: f64,
    /// Readings that were replaced.
    pub implausible: u32,
    /// Oscillations at rest that were noticed.
    pub oscillations: u32,
    /// Models that replaced the one before.
    pub models: u32,
    /// Time with a model whose natural frequency, and whose velocity gain, is off by more than a
    /// factor of [`FAR`] from those of the axis in the middle \[s\].
    pub far_s: [f64; 2],
}

/// Factor on a natural frequency or a velocity gain beyond which a model is far from its axis.
pub const FAR: f64 = 1.3;

/// Whether the natural frequency and the velocity gain of a model in use are far from those of its
/// axis in the middle.
fn far([gain, omega0, _]: [f64; 3], model: &Model) -> [bool; 2] {
    let (a1, b0) = (f64::from(model.a1), f64::from(model.b0));
    [a1.sqrt() / omega0, b0 / a1 / gain].map(|ratio| !(1.0 / FAR..=FAR).contains(&ratio))
}

/// The first axes of a family, from a seed on, that the loop controls with a model near the truth:
/// in two moves and a sine it stays within 5 % of the travel of its reference and comes within 1 %
/// of it at rest. Only the errors decide, not whether the loop stops.
pub fn controlled(family: Family, usual: bool, first: u64, axes: usize) -> Vec<AxisDraw> {
    (first..)
        .map(|seed| AxisDraw::new(family, usual, seed))
        .filter(is_controlled)
        .take(axes)
        .collect()
}

/// Whether the loop controls an axis; what it does until it stops counts.
pub fn is_controlled(axis: &AxisDraw) -> bool {
    let Some(mut machine) = Machine::new(axis, true, true) else {
        return false;
    };
    let length = axis.stroke_mm();
    let worst = |machine: &mut Machine, seconds: f64, limit: f64| {
        let end = machine.bench.time() + seconds;
        while machine.bench.time() < end {
            let report = machine.step();
            if matches!(report.state, State::Failed(_)) {
                return true;
            }
            let error = f64::from(report.setpoint.position) - machine.bench.position_mm();
            if error.abs() > limit * length {
                return false;
            }
        }
        true
    };
    for place in [0.3, 0.6] {
        let _ = machine.servo.move_to((place * length) as f32);
        if !(worst(&mut machine, 3.0, IN_MOTION) && worst(&mut machine, 0.5, AT_REST)) {
            return false;
        }
    }
    let size = amplitude(axis, 0.2, 0.5);
    let _ = machine.servo.oscillate(size as f32, 0.5);
    if !worst(&mut machine, 4.0, IN_MOTION) {
        return false;
    }
    let _ = machine.servo.move_to((0.4 * length) as f32);
    worst(&mut machine, 3.0, IN_MOTION) && range(&mut machine, 2.0) <= axis.cycle_mm()
}

/// Range of the true position in a time, until the loop stops \[mm\].
fn range(machine: &mut Machine, seconds: f64) -> f64 {
    let end = machine.bench.time() + seconds;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    while machine.bench.time() < end {
        let stopped = matches!(machine.step().state, State::Failed(_));
        let x = machine.bench.position_mm();
        (low, high) = (low.min(x), high.max(x));
        if stopped {
            break;
        }
    }
    high - low
}

/// Works for a time with a model near the truth: moves to places on 10 to 90 % of the travel, sines
/// of 0.1 to 5 Hz, small steps, rests.
pub fn work(axis: &AxisDraw, seconds: f64) -> Option<NormalRun> {
    Machine::new(axis, true, true).map(|machine| worked(machine, axis, seconds))
}

/// The same with what a commissioning has found, whose user states nothing that it can find; `None`
/// where it finds no model.
pub fn untold_work(axis: &AxisDraw, seconds: f64) -> Option<NormalRun> {
    Machine::commissioned(axis).map(|machine| worked(machine, axis, seconds))
}

fn worked(mut machine: Machine, axis: &AxisDraw, seconds: f64) -> NormalRun {
    let mut random = stream(axis.seed, Purpose::Sequence);
    let length = axis.stroke_mm();
    let middle = axis.truth(0.5 * length);
    let mut stopped = None;
    let mut worst = 0.0_f64;
    let mut implausible = 0;
    let mut oscillations = 0;
    let mut far_s = [0.0; 2];
    let models = machine.servo.supervisor().counts().0;
    while stopped.is_none() && machine.bench.time() < seconds {
        let lasts = match random.random_range(0..5_u32) {
            0 | 1 => {
                let place = length * random.random_range(0.1..0.9);
                let _ = machine.servo.move_to(place as f32);
                random.random_range(0.2..4.0)
            }
            2 => {
                let here = machine.bench.position_mm() + random.random_range(-1.0..1.0);
                let _ = machine.servo.move_to(here as f32);
                random.random_range(0.2..2.0)
            }
            3 => {
                let frequency = 0.1 * libm::exp(random.random_range(0.0..3.9));
                let part = 0.005 * libm::exp(random.random_range(0.0..4.0));
                let size = amplitude(axis, part, frequency);
                let _ = machine.servo.oscillate(size as f32, frequency as f32);
                (2.0 / frequency).clamp(1.0, 10.0)
            }
            _ => random.random_range(1.0..5.0),
        };
        let end = machine.bench.time() + lasts;
        while machine.bench.time() < end {
            let report = machine.step();
            implausible = report.faults.implausible_readings;
            oscillations = report.faults.oscillations;
            let far = far(middle, machine.servo.controller().model());
            for (time, far) in far_s.iter_mut().zip(far) {
                *time += f64::from(u8::from(far)) * axis.sample_time;
            }
            if let State::Failed(reason) = report.state {
                stopped = Some((reason, machine.bench.time()));
                break;
            }
            let error = f64::from(report.setpoint.position) - machine.bench.position_mm();
            worst = worst.max(error.abs() / length);
        }
    }
    NormalRun {
        seed: axis.seed,
        worked_s: machine.bench.time(),
        stopped,
        worst,
        implausible,
        oscillations,
        models: machine.servo.supervisor().counts().0 - models,
        far_s,
    }
}
