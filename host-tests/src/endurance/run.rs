//! One run, with the estimators for comparison beside it.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use trendid::estimation::{StabilisedForgetting, Terms};
use trendid::inputs::{Coulomb, dead_zone};
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Identifier, Outcome, Structure, structure};

use crate::endurance::axis::{Axis, Integrating, WithFriction};
use crate::endurance::motion::{Commands, Motion};
use crate::endurance::scenario::{Behaviour, Case, Drive};
use crate::oracles::forgetting::{Forgetting, Kind, ServoRows};
use crate::plants::servo::Servo;
use crate::plants::valve::{FrictionDrive, StaticValve};
use crate::signals::noise::{Stream, generator, quantised};

/// Sample time in s.
const DT: f64 = 1e-3;

/// Binary noise before the scenario, and after one whose data do not obey the model, in samples.
const MOTION: u64 = 10_000;

/// The estimate is looked at this often; a prime, so that no period of a command is met.
const LOOK: u64 = 997;

/// Velocity gain of every drive.
const GAIN: f64 = 2500.0;

/// Half width of the dead zone, where the drive has one.
const DEAD_ZONE: f64 = 0.03;

/// Largest allowed errors of C, omega0 and xi in percent, where the data obey the model.
pub const LIMITS_PCT: [f64; 3] = [0.15, 0.1, 0.3];

/// The same ten seconds after data that did not.
pub const RECOVERED_PCT: f64 = 0.1;

/// Largest allowed error in standard deviations.
pub const LIMIT_SIGMA: f64 = 4.0;

/// What came out of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Whether every estimate, standard deviation and factor D was finite, and every D positive.
    pub finite: bool,
    /// Largest errors of C, omega0, xi in percent: all the time, or after the motion that follows the scenario.
    pub errors_pct: [f64; 3],
    /// Largest error over its standard deviation.
    pub over_sigma: f64,
    /// Largest P_ii over its bound; over the prior without a memory.
    pub over_bound: f64,
    /// Share of the samples of the scenario in which the estimate was held.
    pub held: f64,
    /// Largest error in percent of plain, directional and stabilised forgetting; `None` where they were not run.
    pub others_pct: Option<[f64; 3]>,
}

impl Found {
    /// Which limit the run breaks, if any.
    pub fn violation(&self, case: &Case) -> Option<String> {
        let limits = match (case.has_limits(), case.scenario.obeys_model()) {
            (true, true) => LIMITS_PCT,
            (true, false) if case.scenario.recovers() => [RECOVERED_PCT; 3],
            (true, false) => [f64::INFINITY; 3],
            (false, _) => [f64::INFINITY; 3],
        };
        let over = self.errors_pct.iter().zip(limits).any(|(e, l)| !(*e <= l));
        if !self.finite {
            Some("not finite".into())
        } else if over {
            Some(format!("errors above {limits:?} %"))
        } else if case.scenario.obeys_model() && !(self.over_sigma <= LIMIT_SIGMA) {
            Some(format!("error above {LIMIT_SIGMA} sigma"))
        } else if !(self.over_bound <= 1.01) {
            Some("covariance above its bound".into())
        } else {
            None
        }
    }
}

/// One run over `samples` samples of the scenario; the others beside it over at most `others` samples.
pub fn run(case: &Case, seed: u64, samples: u64, others: u64) -> Found {
    let w = case.setup.bandwidth;
    let servo = Servo {
        c: GAIN,
        omega0: w,
        xi: 0.5,
    };
    let third = Integrating::new(servo.a(), servo.b0(), DT);
    let truth = [GAIN, w, 0.5];
    match case.setup.drive {
        Drive::Servo => {
            let identifier = identifier::<3, 5, 1>(case, Structure::SERVO, [0.4]);
            let read = |i: &Identifier<_, 3, 5>| second_order(i);
            Runner::new(case, seed, third, truth, others).go(samples, identifier, |u, _| [u], read)
        }
        Drive::Integrating3 => {
            let identifier = identifier::<3, 3, 1>(case, Structure::INTEGRATING, [0.4]);
            let read = |i: &Identifier<_, 3, 3>| second_order(i);
            Runner::new(case, seed, third, truth, 0).go(samples, identifier, |u, _| [u], read)
        }
        Drive::Integrating2 => {
            let axis = Integrating::new([0.0, w], GAIN * w, DT);
            let identifier = identifier::<2, 2, 1>(case, Structure::INTEGRATING, [0.4]);
            let truth = [GAIN, w, 0.0];
            Runner::new(case, seed, axis, truth, 0).go(samples, identifier, |u, _| [u], first_order)
        }
        Drive::DeadZone => {
            let b0 = [Terms::of(&[0]); 2];
            let structure = Structure::try_with_initial_state(Terms::of(&[1, 2]), b0, true)
                .expect("six parameters");
            let identifier = identifier::<3, 6, 2>(case, structure, [0.4, 1.0]);
            let inputs = |u: f32, _| dead_zone(u, DEAD_ZONE as f32);
            let read = |i: &Identifier<_, 3, 6, 2>| second_order(i);
            Runner::new(case, seed, third, truth, 0).go(samples, identifier, inputs, read)
        }
        Drive::Coulomb => {
            // Friction takes the acceleration of a command of 0.05.
            let friction = FrictionDrive::new(w, GAIN * w, 0.05 * GAIN * w, 0.0);
            let structure: Structure<2, 3, 2> =
                structure!(Terms::of(&[1]), [Terms::of(&[0]); 2], false);
            let identifier = identifier::<2, 3, 2>(case, structure, [0.4, 1.0]);
            let mut friction_input = Coulomb::new(1e-3);
            let inputs = move |u: f32, v: f64| [u, friction_input.update(v as f32)];
            let truth = [GAIN, w, 0.0];
            let axis = WithFriction::new(friction, DT);
            Runner::new(case, seed, axis, truth, 0).go(samples, identifier, inputs, first_order)
        }
    }
}

fn identifier<const M: usize, const N: usize, const I: usize>(
    case: &Case,
    structure: Structure<M, N, I>,
    ranges: [f32; I],
) -> Identifier<FilteredTrends<M>, M, N, I> {
    let bandwidth = case.setup.bandwidth as f32;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, bandwidth)
        .expect("the bandwidth is positive");
    let mut config = Config::new(structure, bandwidth, ranges, 1000.0 / bandwidth);
    config.memory = case.memory.map(|memory| memory as f32);
    if case.setup.drive == Drive::Coulomb {
        // Friction turns with the velocity, anywhere between two samples.
        config.holds[I - 1] = Hold::Mean;
        config.friction_input = Some(I - 1);
    }
    Identifier::try_new(&config, trends).expect("a configuration that works")
}

/// Values and standard deviations of C, omega0, xi.
type Reading = [[f64; 2]; 3];

/// C, omega0, xi of `b0 / (s (s^2 + a2 s + a1))`.
fn second_order<const N: usize, const I: usize>(
    identifier: &Identifier<FilteredTrends<3>, 3, N, I>,
) -> Option<Reading> {
    let estimate = identifier.estimate();
    let theta = estimate.theta();
    let servo = Servo::from_coefficients(theta[0].into(), theta[1].into(), theta[2].into())?;
    let std = estimate.physical_std()?;
    Some([
        [servo.c, std[0].into()],
        [servo.omega0, std[1].into()],
        [servo.xi, std[2].into()],
    ])
}

/// C and a1 of `b0 / (s (s + a1))`.
fn first_order<const N: usize, const I: usize>(
    identifier: &Identifier<FilteredTrends<2>, 2, N, I>,
) -> Option<Reading> {
    let estimate = identifier.estimate();
    let theta = estimate.theta().map(f64::from);
    let p = estimate.covariance().map(|row| row.map(f64::from));
    let gain = theta[1] / theta[0];
    let relative = p[1][1] / theta[1].powi(2) + p[0][0] / theta[0].powi(2)
        - 2.0 * p[0][1] / (theta[0] * theta[1]);
    Some([
        [gain, gain.abs() * relative.max(0.0).sqrt()],
        [theta[0], p[0][0].sqrt()],
        [0.0, 1.0],
    ])
}

/// Three other ways to forget on the same samples.
struct Others {
    rows: ServoRows,
    estimators: [Forgetting<5>; 3],
    left: u64,
    worst: [f64; 3],
}

impl Others {
    fn new(memory: f64, bandwidth: f64, samples: u64) -> Self {
        let kinds = [
            Kind::Plain,
            Kind::Directional,
            Kind::Stabilised { variance: 1e3 },
        ];
        Self {
            rows: ServoRows::new(bandwidth, 0.4, 1000.0 / bandwidth, DT),
            estimators: kinds.map(|kind| Forgetting::new(kind, [1e8; 5], memory / DT)),
            left: samples + MOTION,
            worst: [0.0; 3],
        }
    }

    fn update(&mut self, u: f64, y: f64) {
        if self.left == 0 {
            return;
        }
        self.left -= 1;
        let (phi, psi) = self.rows.update(u, y);
        for estimator in &mut self.estimators {
            estimator.update(&phi, psi);
        }
    }

    fn look(&mut self, truth: &[f64; 3]) {
        let truth = Servo {
            c: truth[0],
            omega0: truth[1],
            xi: truth[2],
        };
        for (worst, estimator) in self.worst.iter_mut().zip(&self.estimators) {
            let theta: [f64; 5] =
                std::array::from_fn(|j| self.rows.units[j] * estimator.theta()[j]);
            let found = Servo::from_coefficients(theta[0], theta[1], theta[2]);
            let error = found.map_or(f64::INFINITY, |found| {
                found
                    .error_pct(&truth)
                    .into_iter()
                    .fold(0.0, |w: f64, e| w.max(e.abs()))
            });
            // f64::max would drop a NaN.
            *worst = if error > *worst || error.is_nan() {
                error
            } else {
                *worst
            };
        }
    }
}

/// Everything of a run but the identifier.
struct Runner<'a, A> {
    case: &'a Case,
    axis: A,
    truth: [f64; 3],
    commands: Commands,
    noise: ChaCha8Rng,
    valve: StaticValve,
    others: Option<Others>,
    found: Found,
}

impl<'a, A: Axis> Runner<'a, A> {
    fn new(case: &'a Case, seed: u64, axis: A, truth: [f64; 3], others: u64) -> Self {
        let dead_zone = match case.setup.drive {
            Drive::DeadZone => DEAD_ZONE,
            _ => 0.0,
        };
        Self {
            case,
            axis,
            truth,
            commands: Commands::new(
                seed,
                case.setup.bandwidth,
                GAIN,
                matches!(case.setup.drive, Drive::DeadZone | Drive::Coulomb),
                DT,
            ),
            noise: generator(seed, Stream::White),
            valve: StaticValve {
                dead_zone,
                ..StaticValve::IDEAL
            },
            others: match case.memory {
                Some(memory) if others > 0 => {
                    Some(Others::new(memory, case.setup.bandwidth, others))
                }
                _ => None,
            },
            found: Found {
                finite: true,
                errors_pct: [0.0; 3],
                over_sigma: 0.0,
                over_bound: 0.0,
                held: 0.0,
                others_pct: None,
            },
        }
    }

    fn measured(&mut self, noisy: bool, resolution: f64) -> f64 {
        let y = self.axis.position();
        let noise = 1e-3 * self.case.setup.noise_um * (self.noise.random::<f64>() - 0.5);
        quantised(if noisy { y + noise } else { y }, resolution)
    }

    fn go<const M: usize, const N: usize, const I: usize>(
        mut self,
        samples: u64,
        mut identifier: Identifier<FilteredTrends<M>, M, N, I>,
        mut inputs: impl FnMut(f32, f64) -> [f32; I],
        read: impl Fn(&Identifier<FilteredTrends<M>, M, N, I>) -> Option<Reading>,
    ) -> Found {
        let scenario = self.case.scenario;
        let bound = self
            .case
            .memory
            .map(|memory| StabilisedForgetting::new([0.0; N], 1.0 - (DT / memory) as f32).bound());
        let prior: [f32; N] = std::array::from_fn(|j| identifier.estimator().covariance(j, j));
        for k in 0..MOTION {
            let y = self.measured(true, 0.0);
            let u = self.commands.next(Motion::Binary, k, y);
            let _ = identifier.update_inputs(inputs(u as f32, self.axis.velocity()), y as f32);
            self.step(u, y, true);
        }
        if self.case.trusted {
            identifier.set_nominal();
            for other in self.others.iter_mut().flat_map(|o| &mut o.estimators) {
                other.set_nominal();
            }
        }
        let from = self.axis.position();
        let ramps = samples.div_ceil(1_000_000).max(1);
        let mut held = 0_u64;
        for k in 0..samples {
            match scenario.behaviour {
                Behaviour::Stands => self.axis.place(from),
                Behaviour::Ramps => {
                    let phase = (k as f64 * ramps as f64 / samples as f64).fract();
                    self.axis
                        .place(from + 1e7 * (1.0 - (2.0 * phase - 1.0).abs()));
                }
                Behaviour::Free => {}
            }
            let y = self.measured(scenario.noise, scenario.resolution);
            let u = self.commands.next(scenario.motion, k, y);
            let outcome =
                identifier.update_inputs(inputs(u as f32, self.axis.velocity()), y as f32);
            held += u64::from(matches!(outcome, Outcome::Held { .. }));
            self.step(u, y, scenario.obeys_model());
            if k % LOOK == LOOK - 1 {
                self.watch(&identifier, bound, &prior);
                if scenario.obeys_model() {
                    self.compare(read(&identifier));
                }
            }
        }
        self.found.held = held as f64 / samples.max(1) as f64;
        if !scenario.obeys_model() {
            self.axis.place(from);
            for k in 0..MOTION {
                let y = self.measured(true, 0.0);
                let u = self.commands.next(Motion::Binary, k, y);
                let _ = identifier.update_inputs(inputs(u as f32, self.axis.velocity()), y as f32);
                self.step(u, y, true);
            }
            self.watch(&identifier, bound, &prior);
            self.compare(read(&identifier));
        }
        self.found.others_pct = self.others.as_ref().map(|others| others.worst);
        self.found
    }

    #[inline]
    fn step(&mut self, u: f64, y: f64, moves: bool) {
        if let Some(others) = &mut self.others {
            others.update(u, y);
        }
        if moves {
            self.axis.step(self.valve.flow(u));
        }
    }

    fn watch<const M: usize, const N: usize, const I: usize>(
        &mut self,
        identifier: &Identifier<FilteredTrends<M>, M, N, I>,
        bound: Option<f32>,
        prior: &[f32; N],
    ) {
        let estimator = identifier.estimator();
        self.found.finite &= estimator
            .diagonal()
            .iter()
            .all(|d| *d > 0.0 && d.is_finite())
            && estimator.theta().iter().all(|t| t.is_finite())
            && identifier.theta().iter().all(|t| t.is_finite());
        for (j, prior) in prior.iter().enumerate() {
            let share = f64::from(estimator.covariance(j, j) / bound.unwrap_or(*prior));
            self.found.over_bound = self.found.over_bound.max(share);
        }
    }

    fn compare(&mut self, reading: Option<Reading>) {
        let Some(reading) = reading else {
            self.found.errors_pct = [f64::INFINITY; 3];
            return;
        };
        for (i, [value, std]) in reading.into_iter().enumerate() {
            let error = (value - self.truth[i]).abs();
            if self.truth[i] > 0.0 {
                let share = 100.0 * error / self.truth[i];
                self.found.errors_pct[i] = larger(self.found.errors_pct[i], share);
            }
            self.found.over_sigma = larger(self.found.over_sigma, error / std);
        }
        if let Some(others) = &mut self.others
            && others.left > 0
        {
            others.look(&self.truth);
        }
    }
}

/// The larger one; NaN is larger than anything.
fn larger(worst: f64, value: f64) -> f64 {
    if value > worst || value.is_nan() {
        value
    } else {
        worst
    }
}
