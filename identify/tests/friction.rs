//! Motors with Coulomb friction, driven openly or by a position controller, from a simulation that
//! shares nothing with the library: their parameters and their delay are as near to the truth as
//! the deviations say, and near enough to be of use.

mod draws;

use draws::Uniform;
use trendid_identify::coulomb_input::{signs, velocity};
use trendid_identify::derived::COULOMB;
use trendid_identify::standstill::standstill;
use trendid_identify::{
    Choice, Freedom, Hold, Identification, Input, Options, Problem, Signals, Structure, identify,
};

/// From here on nothing was tuned.
const FIRST_SEED: u64 = 900_001;

const SAMPLES: usize = 4000;

/// Steps of the simulation in a sample.
const STEPS: usize = 200;

/// What drives the motor.
#[derive(Debug, Clone, Copy)]
enum Drive {
    /// Either sign of one level.
    Levels,
    /// Ten sines.
    Sines,
    /// A controller that moves to places.
    Loop,
    /// Levels held for long.
    Slow,
}

/// `y'' = b u(t - delay) + offset - a y' - friction sgn(y')`, sampled with noise.
struct Motor {
    drive: Drive,
    dt: f64,
    /// a, b, -friction, offset.
    truth: [f64; 4],
    delay: f64,
    u: Vec<f64>,
    y: Vec<f64>,
}

impl Motor {
    fn of(seed: u64, noise: f64, delay: Choice<usize>) -> Self {
        let mut draw = Uniform::of(seed);
        let drive = [Drive::Levels, Drive::Sines, Drive::Loop, Drive::Slow][(seed % 4) as usize];
        let dt = draw.between(0.5e-3, 5e-3);
        let (a, b) = (draw.between(0.2, 20.0), draw.between(1.0, 1000.0));
        let friction = b * (0.02 + 0.23 * draw.next());
        let offset = if draw.yes() {
            0.0
        } else {
            0.05 * b * draw.either_side()
        };
        let drawn = 6.0 * draw.next();
        let delay = match delay {
            Choice::Auto => drawn,
            Choice::Given(delay) => delay as f64,
        };
        let mut motor = Self {
            drive,
            dt,
            truth: [a, b, -friction, offset],
            delay,
            u: Vec::new(),
            y: Vec::new(),
        };
        motor.simulate(&mut draw);
        let range = motor.y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
        for y in &mut motor.y {
            *y += noise * range * draw.normal();
        }
        motor
    }

    fn simulate(&mut self, draw: &mut Uniform) {
        let [_, b, _, offset] = self.truth;
        let (dt, h) = (self.dt, self.dt / STEPS as f64);
        let hold = (draw.between(0.03, 0.5) / dt) as usize + 1;
        let phases: Vec<f64> = (0..10)
            .map(|_| std::f64::consts::TAU * draw.next())
            .collect();
        // A loop of 30 rad/s, as a practitioner tunes it for the inertia.
        let (stiffness, damping) = (0.3 * 900.0 / b, 30.0 / b);
        let (mut level, mut y, mut v) = (0.0, 0.0, 0.0_f64);
        for k in 0..SAMPLES {
            self.y.push(y);
            let begins = |length: usize| k % length == 0;
            self.u.push(match self.drive {
                Drive::Levels => {
                    if begins(hold) {
                        level = (0.3 + 0.7 * draw.next()) * if draw.yes() { 1.0 } else { -1.0 };
                    }
                    level
                }
                Drive::Sines => {
                    let lines = phases
                        .iter()
                        .zip([0.3, 0.7, 1.1, 1.5, 1.9, 2.3, 2.7, 3.1, 3.5, 3.9]);
                    let turn = std::f64::consts::TAU * k as f64 * dt;
                    0.25 * lines
                        .map(|(phase, hz)| (turn * hz + phase).sin())
                        .sum::<f64>()
                }
                Drive::Loop => {
                    if begins(3 * hold) {
                        level = draw.either_side() * b / 900.0;
                    }
                    (stiffness * (level - y) - damping * v).clamp(-1.0, 1.0)
                }
                Drive::Slow => {
                    if begins(2 * hold) {
                        level = draw.either_side();
                    }
                    level
                }
            });
            for step in 0..STEPS {
                let sample = (k as f64 + (step as f64 + 0.5) / STEPS as f64 - self.delay).floor();
                let u = if sample < 0.0 {
                    0.0
                } else {
                    self.u[sample as usize]
                };
                self.moved([&mut y, &mut v], b * u + offset, h);
            }
        }
    }

    /// Place and velocity under a constant force for a while, in closed form: an error of the
    /// simulation would be larger than that of an identification where there is little noise.
    fn moved(&self, [y, v]: [&mut f64; 2], force: f64, mut left: f64) {
        let [a, _, friction, _] = self.truth;
        while left > 0.0 {
            let sign = match *v {
                0.0 if force.abs() <= -friction => return,
                0.0 => force.signum(),
                v => v.signum(),
            };
            let end = (force + friction * sign) / a;
            let stop = match *v * end < 0.0 {
                true => (-*v / end).ln_1p() / a,
                false => f64::INFINITY,
            };
            let t = left.min(stop);
            let decay = (-a * t).exp();
            *y += end * t + (*v - end) * (1.0 - decay) / a;
            *v = match t < stop {
                true => end + (*v - end) * decay,
                false => 0.0,
            };
            left -= t;
        }
    }

    /// The model with its friction out of the positions alone.
    fn identified(&self, delay: Choice<usize>) -> Option<Identification> {
        let signs = signs(&velocity(&self.y, self.dt).expect("a sample time"));
        let still = standstill(&self.y);
        let mut signals = Signals::held(self.dt, &self.u, &self.y);
        signals.inputs.push(Input {
            name: COULOMB,
            samples: &signs,
            delayed: false,
            hold: Hold::Zero,
        });
        signals.standstill = still.as_deref();
        let structure = Structure {
            order: 2,
            integrator: true,
            zeros: 0,
            constant: true,
        };
        let problem = Problem::new(&signals, structure, Options::default()).ok()?;
        let freedom = Freedom {
            pole: Choice::Auto,
            delay,
        };
        identify(&problem, freedom, 0, &()).ok()
    }

    /// Errors of parameters and delay, in standard deviations, and that of b relative to it.
    fn errors(&self, found: &Identification) -> (Vec<f64>, f64) {
        let e = &found.estimate;
        let each = self.truth.iter().zip(e.theta.iter().zip(&e.sigma));
        let mut z: Vec<f64> = each
            .map(|(truth, (v, sigma))| (v - truth) / sigma)
            .collect();
        z.extend((found.delay_sigma()).map(|sigma| (found.delay - self.delay) / sigma));
        (z, (e.b[0][0] / self.truth[1] - 1.0).abs())
    }
}

/// What is found in records.
#[derive(Debug, Default)]
struct Population {
    /// Errors in standard deviations.
    all: Vec<f64>,
    /// Records with one beyond three.
    beyond: u64,
    /// With b within a tenth.
    near: u64,
    refused: u64,
}

impl Population {
    /// Of motors with these seeds; their delay is that of the record where it is given.
    fn of(seeds: impl Iterator<Item = u64>, noise: f64, delay: Choice<usize>) -> Self {
        let mut population = Self::default();
        for seed in seeds {
            let motor = Motor::of(seed, noise, delay);
            let Some(found) = motor.identified(delay) else {
                population.refused += 1;
                println!("{seed}, {:?}: refused", motor.drive);
                continue;
            };
            let (z, error) = motor.errors(&found);
            population.near += u64::from(error < 0.1);
            if !z.iter().all(|z| z.abs() < 3.0) {
                population.beyond += 1;
                println!(
                    "{seed}, {:?}: {:?}, {:?}, {z:.1?}",
                    motor.drive, found.friction, found.way
                );
            }
            population.all.extend(z);
        }
        let within = population.all.iter().filter(|z| z.abs() < 3.0).count();
        println!(
            "{} records beyond three deviations, {} with b within a tenth, {} refused; {:.1} % of {} numbers within three",
            population.beyond,
            population.near,
            population.refused,
            100.0 * within as f64 / population.all.len() as f64,
            population.all.len()
        );
        population
    }
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn friction_and_a_delay_are_found_and_their_deviations_hold() {
    const RECORDS: u64 = 40;
    let seeds = FIRST_SEED..FIRST_SEED + RECORDS;
    let found = Population::of(seeds, 1e-3, Choice::Auto);
    assert!(20 * found.beyond <= RECORDS && 20 * found.refused <= RECORDS);
    assert!(10 * found.near >= 9 * RECORDS);
}

/// Short motions, behind whose noise no measured sign is of use: the simulation of the motion alone
/// tells gain and friction.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn a_gain_is_found_behind_much_noise_in_a_loop() {
    const RECORDS: u64 = 20;
    let seeds = (FIRST_SEED..).filter(|seed| seed % 4 == 2);
    let found = Population::of(seeds.take(RECORDS as usize), 1e-2, Choice::Auto);
    assert!(4 * found.near >= 3 * RECORDS && 10 * found.refused <= RECORDS);
}
