//! The identifier of the core on the record of a user.

use trendid::estimation::{Parameter, Terms};
use trendid::inputs::{DeadZone, Valved};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Estimate, Identifier, Structure};

use crate::users::draw::User;
use crate::users::kind::Kind;
use crate::users::reading::{Quantity, Reading};
use crate::users::record::{Event, Record};

/// Largest dead zone that is looked for, over the command.
const LARGEST_DEAD_ZONE: f64 = 0.4;

/// Time after which the bandwidth is told anew, in 1/w.
const RETUNED_AFTER: f64 = 25.0;

/// Least noise that is told over the range that is told: a digit or two of f32.
const LEAST_NOISE: f64 = 1e-5;

/// An identifier, and what is around it.
trait Core<const M: usize, const N: usize, const I: usize> {
    /// Takes a command and a position.
    fn take(&mut self, u: f32, y: f32);
    fn skip(&mut self, samples: u32);
    fn retune_to(&mut self, omega: f32) -> Result<(), ConfigError>;
    fn estimate(&self) -> Estimate<M, N, I>;
    /// The dead zone, where one is measured.
    fn dead_zone(&self) -> Option<&DeadZone>;
}

impl<const M: usize, const N: usize> Core<M, N, 1> for Identifier<FilteredTrends<M>, M, N> {
    fn take(&mut self, u: f32, y: f32) {
        let _ = self.update(u, y);
    }

    fn skip(&mut self, samples: u32) {
        Self::skip(self, samples);
    }

    fn retune_to(&mut self, omega: f32) -> Result<(), ConfigError> {
        Self::retune_to(self, omega)
    }

    fn estimate(&self) -> Estimate<M, N, 1> {
        Self::estimate(self)
    }

    fn dead_zone(&self) -> Option<&DeadZone> {
        None
    }
}

impl<const M: usize, const N: usize> Core<M, N, 2> for Valved<FilteredTrends<M>, M, N> {
    fn take(&mut self, u: f32, y: f32) {
        let _ = self.update(u, y);
    }

    fn skip(&mut self, samples: u32) {
        Self::skip(self, samples);
    }

    fn retune_to(&mut self, omega: f32) -> Result<(), ConfigError> {
        Self::retune_to(self, omega)
    }

    fn estimate(&self) -> Estimate<M, N, 2> {
        Self::estimate(self)
    }

    fn dead_zone(&self) -> Option<&DeadZone> {
        Some(Self::dead_zone(self))
    }
}

/// What a user reads of the identifier.
///
/// # Errors
/// What is wrong with what the user tells.
pub fn readings(user: &User, record: &Record) -> Result<Vec<Reading>, ConfigError> {
    let of = Terms::of;
    let (pair, b0) = (of(&[0, 1]), of(&[0]));
    match user.kind {
        Kind::Servo => run(user, record, Structure::<3, 5, 1>::SERVO),
        Kind::ServoPlain => run(user, record, Structure::<3, 3, 1>::INTEGRATING),
        Kind::ServoZero => {
            let terms = Structure::try_with_initial_state(of(&[1, 2]), [pair], true)?;
            run::<3, 6>(user, record, terms)
        }
        Kind::ServoDeadZone => run_valved(user, record, Structure::<3, 6, 2>::SERVO),
        Kind::Fourth => run(user, record, Structure::<4, 6, 1>::SERVO),
        Kind::Motor => run(user, record, Structure::<2, 4, 1>::SERVO),
        Kind::MotorPlain => run(user, record, Structure::<2, 2, 1>::INTEGRATING),
        Kind::Oscillator => run::<2, 4>(user, record, Structure::try_new(pair, [b0], true)?),
        Kind::OscillatorPlain => run::<2, 3>(user, record, Structure::try_new(pair, [b0], false)?),
        Kind::OscillatorZero => run(user, record, Structure::<2, 4, 1>::FULL),
        Kind::Lag => run::<1, 3>(user, record, Structure::try_new(b0, [b0], true)?),
        Kind::LagPlain => run(user, record, Structure::<1, 2, 1>::FULL),
    }
}

/// A core that takes a record.
struct Run<'a, C> {
    user: &'a User,
    record: &'a Record,
    core: C,
}

fn trends<const M: usize>(user: &User, bandwidth: f32) -> Result<FilteredTrends<M>, ConfigError> {
    FilteredTrends::for_bandwidth(Scheme::Tustin, user.sample_time as f32, bandwidth)
}

fn run<const M: usize, const N: usize>(
    user: &User,
    record: &Record,
    structure: Structure<M, N, 1>,
) -> Result<Vec<Reading>, ConfigError> {
    let config = told(user, record, structure);
    let core = Identifier::<_, M, N>::try_new(&config, trends(user, config.bandwidth)?)?;
    Run { user, record, core }.all()
}

fn run_valved<const M: usize, const N: usize>(
    user: &User,
    record: &Record,
    structure: Structure<M, N, 2>,
) -> Result<Vec<Reading>, ConfigError> {
    let config = told(user, record, structure);
    let block = 0.5 * user.told.memory.unwrap_or(1.0) / user.sample_time;
    let largest = (LARGEST_DEAD_ZONE * user.sizes[0]) as f32;
    let dead_zone = DeadZone::new(0.0, largest, block.max(2.0) as u32);
    let trends = trends(user, config.bandwidth)?;
    let core = Valved::<_, M, N>::try_new(&config, trends, dead_zone)?;
    Run { user, record, core }.all()
}

/// What the user tells.
fn told<const M: usize, const N: usize, const I: usize>(
    user: &User,
    record: &Record,
    structure: Structure<M, N, I>,
) -> Config<M, N, I> {
    let told = &user.told;
    // The second input is the sign of the first.
    let mut ranges = [1.0; I];
    ranges[0] = (record.command * told.input_range) as f32;
    let output_range = record.motion * told.output_range;
    let bandwidth = user.omega * told.bandwidth;
    let mut config = Config::new(structure, bandwidth as f32, ranges, output_range as f32);
    if let Some(factor) = told.noise {
        config.output_noise = (record.noise * factor).max(LEAST_NOISE * output_range) as f32;
    }
    let shortest = 1.01 * (N * (N - 1)) as f64 * user.sample_time;
    config.memory = told.memory.map(|memory| memory.max(shortest) as f32);
    config
}

impl<C> Run<'_, C> {
    fn all<const M: usize, const N: usize, const I: usize>(
        &mut self,
    ) -> Result<Vec<Reading>, ConfigError>
    where
        C: Core<M, N, I>,
    {
        let mut due = Record::readings(self.user).into_iter().peekable();
        let mut retuned = self.user.told.retuned;
        let mut readings = Vec::new();
        let mut k = 0;
        for event in &self.record.events {
            match *event {
                Event::Skip(samples) => {
                    self.core.skip(samples);
                    k += samples as usize;
                }
                Event::Sample { u, y } => {
                    self.core.take(u as f32, y as f32);
                    k += 1;
                }
            }
            let time = k as f64 * self.user.angle();
            if time > RETUNED_AFTER
                && let Some(factor) = retuned.take()
            {
                self.core.retune_to((self.user.omega * factor) as f32)?;
            }
            if due.peek().is_some_and(|at| k >= *at) {
                while due.next_if(|at| k >= *at).is_some() {}
                readings.push(self.reading(time));
            }
        }
        Ok(readings)
    }

    fn reading<const M: usize, const N: usize, const I: usize>(&self, time: f64) -> Reading
    where
        C: Core<M, N, I>,
    {
        let estimate = self.core.estimate();
        let mut quantities = self.parameters(&estimate);
        quantities.extend(self.physical(&estimate));
        if let Some(dead_zone) = self.core.dead_zone() {
            let truth = self.user.dead_zone * self.user.sizes[0];
            let [value, deviation] = [dead_zone.delta(), dead_zone.std()].map(f64::from);
            quantities.push(Quantity::new("delta", value, truth, deviation));
        }
        Reading { time, quantities }
    }

    fn parameters<const M: usize, const N: usize, const I: usize>(
        &self,
        estimate: &Estimate<M, N, I>,
    ) -> Vec<Quantity> {
        let User { a, b, sizes, .. } = self.user;
        let (offset, width) = (self.user.offset * sizes[0], self.user.dead_zone * sizes[0]);
        let made = (b[0] * self.record.command).abs();
        let parameters = estimate.structure().parameters();
        let read = parameters
            .into_iter()
            .zip(estimate.theta())
            .zip(estimate.std());
        let one = |((parameter, value), deviation)| {
            let of = |name: &str, truth: f64| {
                Quantity::new(name, f64::from(value), truth, f64::from(deviation))
            };
            Some(match parameter {
                Parameter::Output { power } => of(&format!("a{power}"), a[power]),
                Parameter::Input { input: 0, power } => of(&format!("b{power}"), b[power]),
                Parameter::Input { .. } => Quantity {
                    size: made,
                    ..of("b0 sgn", -b[0] * width)
                },
                Parameter::Constant => Quantity {
                    size: made,
                    ..of("c", b[0] * offset)
                },
                Parameter::InitialState => return None,
            })
        };
        read.filter_map(one).collect()
    }

    /// C, omega0 and xi, where they exist.
    fn physical<const M: usize, const N: usize, const I: usize>(
        &self,
        estimate: &Estimate<M, N, I>,
    ) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        if let Some(deviations) = estimate.physical_std() {
            let read = estimate.physical();
            let read = [read.gain, read.omega0, read.damping];
            let truth = physical_truth(self.user);
            for ((name, truth), (value, deviation)) in
                truth.into_iter().zip(read.into_iter().zip(deviations))
            {
                quantities.extend(value.map(|value| {
                    Quantity::new(name, f64::from(value), truth, f64::from(deviation))
                }));
            }
        }
        quantities
    }
}

/// C, omega0 and xi of a drive with two poles behind its integrators.
pub fn physical_truth(user: &User) -> [(&'static str, f64); 3] {
    let stiffness = user.a.iter().find(|a| **a != 0.0).unwrap_or(&1.0);
    [
        ("C", user.b[0] / stiffness),
        ("omega0", user.omega),
        ("xi", user.damping),
    ]
}
