//! The drive under the loop, and how a scenario changes it.

use crate::plants::linear::{Input, LinearPlant};
use crate::plants::pneumatic::{AxisParameters, Fault, PneumaticAxis};
use crate::plants::servo::{REFERENCE, Servo};
use crate::plants::valve::StaticValve;
use crate::servo::scenario::Scenario;
use crate::signals::noise::{Additive, Condition};

/// Resolution of the sensor of both plants \[mm\].
pub const RESOLUTION_MM: f64 = 0.01;

/// The drive under the loop.
pub enum Plant {
    /// The pneumatic axis.
    Pneumatic(Box<PneumaticAxis>),
    /// The reference servo behind a valve with dead zone, with the same sensor as the axis.
    Linear {
        /// The servo.
        plant: Box<LinearPlant>,
        /// Its valve.
        valve: StaticValve,
        /// Noise of the sensor.
        noise: Box<Additive>,
    },
}

impl Plant {
    /// The pneumatic axis of the figures.
    pub fn pneumatic(parameters: &AxisParameters, seed: u64) -> Self {
        Self::Pneumatic(Box::new(PneumaticAxis::new(parameters, seed)))
    }

    /// The linear reference servo at 200 mm with a dead zone of 3 % and noise of +-10 um.
    pub fn linear(seed: u64) -> Self {
        Self::behind_dead_zone(REFERENCE.plant(1e-3), 200.0, seed)
    }

    /// Code of the sensor at the present instant.
    pub(crate) fn code(&mut self) -> i32 {
        match self {
            Self::Pneumatic(axis) => axis.measure_counts(),
            Self::Linear { plant, noise, .. } => {
                let noise = noise.next().unwrap_or(0.0);
                ((plant.output() + noise) / RESOLUTION_MM).round() as i32
            }
        }
    }

    /// Holds a command until the next sample.
    pub(crate) fn step(&mut self, u: f64) {
        match self {
            Self::Pneumatic(axis) => axis.step(u),
            Self::Linear { plant, valve, .. } => {
                plant.step(&[valve.flow(u)]);
            }
        }
    }

    /// Brings the change or the fault of a scenario; `seed` is that of its noise.
    pub(crate) fn change(&mut self, scenario: Scenario, seed: u64) {
        if scenario == Scenario::WrongOrder {
            *self = Self::of_other_order(self.position_mm(), seed);
            return;
        }
        match self {
            Self::Pneumatic(axis) => change_axis(axis, scenario),
            Self::Linear { plant, valve, .. } => {
                change_valve(valve, scenario);
                change_servo(plant, scenario);
            }
        }
    }

    /// A drive held by a spring behind a slow valve: order 4, and no integrator.
    fn of_other_order(position_mm: f64, seed: u64) -> Self {
        // (s + 60)(s + 30)(s^2 + 20 s + 400), 60 mm per unit of command.
        let a = [720_000.0, 72_000.0, 4_000.0, 110.0];
        let constant = a[0] * position_mm;
        let plant = LinearPlant::with_inputs(&a, &[Input::new(&[60.0 * a[0]])], constant, 1e-3);
        let Ok(plant) = plant else {
            panic!("a plant of order 4");
        };
        Self::behind_dead_zone(plant, position_mm, seed)
    }

    /// A linear plant at rest behind a valve with a dead zone of 3 %, measured with noise of +-10
    /// um.
    fn behind_dead_zone(mut plant: LinearPlant, position_mm: f64, seed: u64) -> Self {
        plant.reset(position_mm);
        Self::Linear {
            plant: Box::new(plant),
            valve: StaticValve {
                dead_zone: 0.03,
                ..StaticValve::IDEAL
            },
            noise: Box::new(Additive::new(&Condition::white(20.0), seed)),
        }
    }

    /// Flow opening of the valve.
    pub(crate) fn opening(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.opening(),
            Self::Linear { .. } => 0.0,
        }
    }

    /// True position \[mm\].
    pub fn position_mm(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.position_mm(),
            Self::Linear { plant, .. } => plant.output(),
        }
    }
}

fn change_axis(axis: &mut PneumaticAxis, scenario: Scenario) {
    match scenario {
        Scenario::Mass => axis.set_mass(3.0 * axis.parameters().mass),
        Scenario::Supply => axis.set_supply(4.0),
        Scenario::ValveGain => axis.set_valve_gain(0.7),
        Scenario::Friction => axis.set_friction_scale(2.0),
        Scenario::WrongSign => axis.set_fault(Some(Fault::WrongSign)),
        Scenario::StuckSensor => axis.set_fault(Some(Fault::StuckSensor)),
        Scenario::StuckValve => axis.set_fault(Some(Fault::StuckValve)),
        Scenario::BlockedAxis => axis.set_fault(Some(Fault::BlockedAxis)),
        Scenario::Nominal | Scenario::Rest | Scenario::WrongOrder => {}
    }
}

fn change_valve(valve: &mut StaticValve, scenario: Scenario) {
    let gain = match scenario {
        Scenario::ValveGain => 0.7,
        Scenario::WrongSign => -1.0,
        Scenario::StuckValve => 0.0,
        _ => return,
    };
    valve.gain_positive = gain;
    valve.gain_negative = gain;
    if scenario == Scenario::StuckValve {
        valve.limit = 0.0;
    }
}

/// Another servo in the position and the motion of the present one.
fn change_servo(plant: &mut LinearPlant, scenario: Scenario) {
    let servo = match scenario {
        // A third of the stiffness per mass; gain and damping ratio stay.
        Scenario::Mass => Servo {
            omega0: REFERENCE.omega0 / 3.0_f64.sqrt(),
            ..REFERENCE
        },
        Scenario::Supply => Servo {
            c: 0.7 * REFERENCE.c,
            omega0: 0.85 * REFERENCE.omega0,
            ..REFERENCE
        },
        Scenario::Friction => Servo {
            xi: 2.0 * REFERENCE.xi,
            ..REFERENCE
        },
        _ => return,
    };
    let state = [plant.output(), plant.derivative(1), plant.derivative(2)];
    *plant = servo.plant(1e-3);
    plant.place(&state);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes of 0.2 s behind the change of a scenario.
    fn codes(scenario: Scenario, linear: bool, seed: u64) -> Vec<i32> {
        let mut plant = match linear {
            true => Plant::linear(seed),
            false => Plant::pneumatic(&AxisParameters::SERVO, seed),
        };
        plant.change(scenario, seed);
        let code = |_| {
            plant.step(0.0);
            plant.code()
        };
        (0..200).map(code).collect()
    }

    #[test]
    fn the_seed_reaches_the_noise_of_every_scenario() {
        for linear in [false, true] {
            for scenario in Scenario::ALL {
                let [first, again, other] = [5, 5, 6].map(|seed| codes(scenario, linear, seed));
                assert_eq!(first, again, "{scenario:?}");
                // A sensor that repeats its last code shows no noise.
                let silent = !linear && scenario == Scenario::StuckSensor;
                assert!(silent || first != other, "{scenario:?}, linear: {linear}");
            }
        }
    }
}
