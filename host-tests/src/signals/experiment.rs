//! A simulated experiment: plant, excitation, valve and noise put together into a record.
//!
//! Positions are in mm (the widths of [`Condition`] are in um and converted), commands in units,
//! time in s.

use crate::plants::linear::LinearPlant;
use crate::plants::servo::REFERENCE;
use crate::plants::valve::StaticValve;
use crate::signals::excitation::{Controller, Excitation};
use crate::signals::noise::{Additive, Condition, Reading, quantised};

/// What there is at one instant: `y` is sampled, then `u` is held until the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time \[s\].
    pub t: f64,
    /// Command, before the valve.
    pub u: f64,
    /// Measured position \[mm\].
    pub y: f64,
    /// True position \[mm\].
    pub y_true: f64,
}

/// A record of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sampling interval \[s\].
    pub dt: f64,
    /// Commands.
    pub u: Vec<f64>,
    /// Measured positions \[mm\].
    pub y: Vec<f64>,
    /// True positions \[mm\].
    pub y_true: Vec<f64>,
    /// Factor by which the widths of the condition were scaled (1 in ABSOLUTE).
    pub scale: f64,
}

impl Record {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.u.len()
    }

    /// Whether the record has no samples.
    pub fn is_empty(&self) -> bool {
        self.u.is_empty()
    }

    /// The samples in order of time.
    pub fn samples(&self) -> impl Iterator<Item = Sample> + '_ {
        (0..self.len()).map(|k| Sample {
            t: k as f64 * self.dt,
            u: self.u[k],
            y: self.y[k],
            y_true: self.y_true[k],
        })
    }

    /// Measured minus true positions \[mm\].
    pub fn noise(&self) -> Vec<f64> {
        self.y
            .iter()
            .zip(&self.y_true)
            .map(|(y, x)| y - x)
            .collect()
    }
}

/// An experiment on a plant with one input; every field may be replaced before
/// [`record`](Self::record).
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The plant, in its initial state; its interval must be that of the condition.
    pub plant: LinearPlant,
    /// Valve in front of the plant.
    pub valve: StaticValve,
    /// Command, or reference position \[mm\] when a controller is given.
    pub excitation: Excitation,
    /// Controller that closes the loop on the measured position.
    pub controller: Option<Controller>,
    /// Noise and sampling interval.
    pub condition: Condition,
    /// Duration \[s\].
    pub duration_s: f64,
}

impl Experiment {
    /// The reference servo under binary noise, +-0.4 held 50 ms (ABSOLUTE) or +-1 held 40 ms
    /// (RELATIVE).
    pub fn reference(condition: Condition, duration_s: f64) -> Self {
        Self {
            plant: REFERENCE.plant(condition.dt()),
            valve: StaticValve::IDEAL,
            excitation: match condition.reading {
                Reading::Absolute => Excitation::ABSOLUTE,
                Reading::Relative => Excitation::RELATIVE,
            },
            controller: None,
            condition,
            duration_s,
        }
    }

    /// The reference servo in closed loop with [`Controller::SERVO`], following binary steps
    /// of +-60 mm held 300 ms.
    pub fn closed_loop(condition: Condition, duration_s: f64) -> Self {
        Self {
            excitation: Excitation::Prbs {
                amplitude: 60.0,
                hold_s: 0.3,
                bits: 11,
            },
            controller: Some(Controller::SERVO),
            ..Self::reference(condition, duration_s)
        }
    }

    /// Runs the experiment; the same seed gives the same record.
    ///
    /// In closed loop the noise enters sample by sample, so its widths are those printed, also in
    /// RELATIVE.
    ///
    /// # Panics
    /// When the plant's interval is not that of the condition or the plant has several inputs.
    pub fn record(&self, seed: u64) -> Record {
        let dt = self.condition.dt();
        assert!(
            (self.plant.dt() - dt).abs() <= 1e-12 * dt,
            "plant sampled at {} s, condition at {dt} s",
            self.plant.dt()
        );
        let n = (self.duration_s / dt).round() as usize;
        let input = self.excitation.sequence(n, dt, seed);
        let mut plant = self.plant.clone();
        let Some(mut controller) = self.controller else {
            let flow: Vec<f64> = input.iter().map(|&u| self.valve.flow(u)).collect();
            let y_true = plant.response(&flow);
            let (y, scale) = self.condition.measure(&y_true, seed);
            return Record {
                dt,
                u: input,
                y,
                y_true,
                scale,
            };
        };
        let mut noise = Additive::new(&self.condition, seed);
        let mut record = Record {
            dt,
            u: Vec::with_capacity(n),
            y: Vec::with_capacity(n),
            y_true: Vec::with_capacity(n),
            scale: 1.0,
        };
        for r in input {
            let y_true = plant.output();
            let disturbed = y_true + noise.next().unwrap_or(0.0);
            let y = quantised(disturbed, 1e-3 * self.condition.eps_um);
            let u = controller.command(r, y, dt);
            plant.step(&[self.valve.flow(u)]);
            record.u.push(u);
            record.y.push(y);
            record.y_true.push(y_true);
        }
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_comes_before_the_command_acts() {
        let record = Experiment::reference(Condition::CLEAN, 0.2).record(1);
        assert_eq!((record.len(), record.y[0]), (200, 0.0));
        // x(dt) = b0 dt^3 / 6 u to first order.
        let first = 1e6 * 1e-9 / 6.0 * record.u[0];
        assert!((record.y[1] / first - 1.0).abs() < 0.01);
        let last = record.samples().last().unwrap();
        assert!((last.t - 0.199).abs() < 1e-12 && last.y == last.y_true);
    }

    #[test]
    fn closed_loop_with_a_dead_zone_stays_near_its_reference() {
        let mut experiment = Experiment::closed_loop(Condition::white(20.0), 4.0);
        experiment.valve.dead_zone = 0.03;
        let record = experiment.record(2);
        assert!(record.y_true.iter().all(|y| y.abs() < 90.0));
        assert!(record.noise().iter().all(|n| n.abs() <= 0.010_001));
        assert!(record.y_true.iter().any(|y| *y > 5.0) && record.y_true.iter().any(|y| *y < -5.0));
        assert_eq!(record, experiment.record(2));
    }
}
