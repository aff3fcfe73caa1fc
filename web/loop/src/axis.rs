//! The pneumatic axis of the project's figures under the adaptive loop.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, ServoLoop, Travel};
use trendid_host_tests::plants::pneumatic::{AxisParameters, Fault, PneumaticAxis};
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve};

/// Sample time in s.
const DT: f32 = 1e-3;

/// The axis with its loop.
pub(crate) struct AxisPlay {
    axis: PneumaticAxis,
    servo: ServoLoop<SimulatedSensor, SimulatedValve>,
    words: String,
    tick: u32,
}

impl AxisPlay {
    /// The axis at rest, its loop idle; `None` when the settings do not work.
    pub(crate) fn new(noise_um: f32, resolution_um: f32, memory: f32, seed: u32) -> Option<Self> {
        let parameters = AxisParameters {
            sensor_noise_mm: 1e-3 * f64::from(noise_um),
            resolution_mm: 1e-3 * f64::from(resolution_um),
            ..AxisParameters::SERVO
        };
        let fits = (0.0..=1000.0).contains(&noise_um) && (0.1..=1000.0).contains(&resolution_um);
        let scale = Scale::new(1e-3 * resolution_um).filter(|_| fits)?;
        let travel = Travel {
            min: 0.0,
            max: 1e3 * parameters.stroke as f32,
        };
        let mut config = Config::minimal(DT, travel);
        config.memory = memory;
        let sensor = Axis {
            scale,
            reference: 0,
        };
        let servo =
            ServoLoop::try_new(&config, sensor, SimulatedSensor::default(), SimulatedValve).ok()?;
        Some(Self {
            axis: PneumaticAxis::new(&parameters, u64::from(seed)),
            servo,
            words: "idle".into(),
            tick: 0,
        })
    }

    /// Asks: 0 commission, 1 stop, 2 move to a, 3 oscillate with amplitude a and frequency b, 4
    /// factor a on the mass, 5 freeze the sensor, 6 close the supply to a bar, 7 heal.
    pub(crate) fn ask(&mut self, what: u32, a: f32, b: f32) -> Result<(), String> {
        let state = self.servo.supervisor().state();
        match what {
            0 => self.servo.commission(),
            1 => self.servo.abort(),
            2 | 3 if !state.is_controlling() => {
                return Err("the loop does not control the axis: commission it first".into());
            }
            2 => self.servo.move_to(a).map_err(|error| error.to_string())?,
            3 => self
                .servo
                .oscillate(a, b)
                .map_err(|error| error.to_string())?,
            4 if a > 0.0 && a < 100.0 => {
                self.axis
                    .set_mass(f64::from(a) * AxisParameters::SERVO.mass);
            }
            5 => self.axis.set_fault(Some(Fault::StuckSensor)),
            6 if a > 0.01 && a < 20.0 => self.axis.set_supply(f64::from(a)),
            7 => {
                self.axis.set_fault(None);
                self.axis.set_mass(AxisParameters::SERVO.mass);
                self.axis.set_supply(AxisParameters::SERVO.supply_bar);
            }
            _ => return Err("that cannot be asked".into()),
        }
        Ok(())
    }

    /// One sample: t, r, y, u, innovation, state, reason (255: none), whether a model reached the
    /// controller.
    pub(crate) fn step(&mut self) -> [f32; 8] {
        self.servo.sensor_mut().code = Some(self.axis.measure_counts());
        let report = self.servo.update();
        self.axis.step(f64::from(report.command));
        self.tick += 1;
        let words = report.state.to_string();
        if words != self.words {
            self.words = words;
        }
        let reason = report
            .state
            .reason()
            .map_or(255.0, |reason| f32::from(reason as u8));
        [
            self.tick as f32 * DT,
            report.setpoint.position,
            report.position,
            report.command,
            report.innovation.unwrap_or(f32::NAN),
            f32::from(report.state.code()),
            reason,
            f32::from(u8::from(report.retuned)),
        ]
    }

    /// The state in words.
    pub(crate) fn words(&self) -> String {
        self.words.clone()
    }

    /// a1, a2, b0, their standard deviations, the model in the controller, models accepted and
    /// refused.
    pub(crate) fn read(&self) -> [f32; 14] {
        let found = self.servo.identifier().recursion();
        let (theta, std) = (found.theta(), found.std());
        let [a1, a2, b0, dead_zone, offset, friction] = self.servo.controller().model().fields();
        let (accepted, refused) = self.servo.supervisor().counts();
        [
            theta[0],
            theta[1],
            theta[2],
            std[0],
            std[1],
            std[2],
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
            accepted as f32,
            refused as f32,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(play: &mut AxisPlay, samples: u32) -> [f32; 8] {
        (0..samples).map(|_| play.step()).last().unwrap()
    }

    #[test]
    fn it_is_commissioned_moves_and_says_why_it_stops() {
        let mut play = AxisPlay::new(10.0, 10.0, 1.5, 200_001).unwrap();
        assert!(
            play.ask(2, 100.0, 0.0).is_err(),
            "nothing moves before the commissioning"
        );
        play.ask(0, 0.0, 0.0).unwrap();
        let row = run(&mut play, 6000);
        assert!((3.0..6.0).contains(&row[5]), "{}", play.words());
        play.ask(2, 300.0, 0.0).unwrap();
        let row = run(&mut play, 4000);
        assert!((row[2] - 300.0).abs() < 1.0, "{row:?}");
        assert!(play.ask(3, 1e6, 1.0).is_err());
        play.ask(5, 0.0, 0.0).unwrap();
        play.ask(2, 100.0, 0.0).unwrap();
        let row = run(&mut play, 3000);
        assert_eq!(row[5], 7.0, "{}", play.words());
        assert!(play.words().starts_with("failed: "), "{}", play.words());
    }
}
