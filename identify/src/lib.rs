//! The core behind sizes that are known only at run time.
//!
//! The core fixes its sizes at compile time. A command line does not know them, so
//! this file instantiates the core for every order and number of parameters it
//! offers and hides the choice behind a trait object. It computes nothing itself.

use trendid::{
    Config, ConfigError, ExactTrends, FilteredTrends, Hold, Identifier, Image, NoiseGain, Outcome,
    Physical, Quality, RawTrends, Scheme, Structure, Terms, TransferFunction, TrendOperator,
    Trends,
};

/// Most inputs that a run-time structure can have.
pub const INPUTS: usize = 4;
/// Longest delay in samples.
pub const DELAY: usize = 512;
/// Most parameters.
pub const PARAMETERS: usize = 10;

/// One input of a run-time structure.
#[derive(Debug, Clone, PartialEq)]
pub struct InputSetup {
    /// Which b_i exist.
    pub terms: Terms,
    /// What the input does between samples.
    pub hold: Hold,
    /// Delay in samples.
    pub delay: usize,
    /// Typical size.
    pub range: f32,
    /// Value at which the plant rested before the record.
    pub rest: f32,
}

/// The trends in front of the estimator.
#[derive(Debug, Clone, PartialEq)]
pub enum Filter {
    /// The paper's raw trends.
    None,
    /// Coefficients f_0 .. f_{m-1} of the filter polynomial.
    Polynomial(Vec<f32>),
    /// Exact trends (Tustin) with this filter polynomial, and the numerators of this denominator.
    Exact {
        /// f_0 .. f_{m-1}.
        filter: Vec<f32>,
        /// a_0 .. a_{m-1}; the filter itself where nothing is known yet.
        model: Vec<f32>,
    },
}

/// Everything that [`Config`] and the trend operator need, with sizes as values.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Order m, 1..=4.
    pub order: usize,
    /// Which a_i exist.
    pub output: Terms,
    /// The inputs, at most [`INPUTS`].
    pub inputs: Vec<InputSetup>,
    /// Whether there is a constant input.
    pub constant: bool,
    /// Whether the start is a parameter.
    pub start: bool,
    /// Delta in s.
    pub sample_time: f32,
    /// Goodwin or Tustin.
    pub scheme: Scheme,
    /// Raw or filtered trends.
    pub filter: Filter,
    /// Rough bandwidth in rad/s.
    pub bandwidth: f32,
    /// Typical movement of the output.
    pub output_range: f32,
    /// Expected noise of the output, standard deviation.
    pub output_noise: f32,
    /// Memory in s.
    pub memory: Option<f32>,
    /// Settling before the first estimate, in s.
    pub settling: f32,
    /// Weight of the pull toward the trusted estimate.
    pub pull: f32,
}

impl Setup {
    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        let numerators: usize = self.inputs.iter().map(|input| input.terms.count()).sum();
        self.output.count() + numerators + usize::from(self.constant) + usize::from(self.start)
    }

    /// Builds the core for this setup.
    ///
    /// # Errors
    /// The core's own [`ConfigError`]; more inputs or parameters than offered are
    /// reported as a parameter count.
    pub fn build(&self) -> Result<Box<dyn Recursion>, ConfigError> {
        if self.inputs.len() > INPUTS {
            return Err(ConfigError::ParameterCount {
                found: self.inputs.len(),
                expected: INPUTS,
            });
        }
        match self.order {
            1 => sized::<1>(self),
            2 => sized::<2>(self),
            3 => sized::<3>(self),
            4 => sized::<4>(self),
            order => Err(ConfigError::OutOfRange {
                setting: "order".into(),
                value: order as f32,
                limits: [1.0, 4.0],
            }),
        }
    }

    fn config<const M: usize, const N: usize>(&self) -> Result<Config<M, N, INPUTS>, ConfigError> {
        let mut terms = [Terms::NONE; INPUTS];
        for (slot, input) in terms.iter_mut().zip(&self.inputs) {
            *slot = input.terms;
        }
        let structure = if self.start {
            Structure::try_with_initial_state(self.output, terms, self.constant)?
        } else {
            Structure::try_new(self.output, terms, self.constant)?
        };
        let mut config = Config::new(structure, self.bandwidth, [1.0; INPUTS], self.output_range);
        for (c, input) in self.inputs.iter().enumerate() {
            config.input_range[c] = input.range;
            config.holds[c] = input.hold;
            config.delays[c] = input.delay;
            config.rest[c] = input.rest;
        }
        config.output_noise = self.output_noise;
        config.memory = self.memory;
        config.settling = self.settling;
        config.pull = self.pull;
        Ok(config)
    }
}

/// Raw, filtered or exact trends behind one type, so that each size is compiled once.
#[derive(Debug, Clone, Copy, PartialEq)]
enum AnyTrends<const M: usize> {
    Raw(RawTrends<M>),
    Filtered(FilteredTrends<M>),
    Exact(ExactTrends<M>),
}

/// Calls the same method on whichever operator it is.
macro_rules! either {
    ($self:ident, $trends:ident => $call:expr) => {
        match $self {
            Self::Raw($trends) => $call,
            Self::Filtered($trends) => $call,
            Self::Exact($trends) => $call,
        }
    };
}

impl<const M: usize> TrendOperator<M> for AnyTrends<M> {
    type Memory = [f32; M];
    const EMPTY: [f32; M] = [0.0; M];

    fn sample_time(&self) -> f32 {
        either!(self, t => t.sample_time())
    }
    fn settled(&self, value: f32) -> [f32; M] {
        either!(self, t => t.settled(value))
    }
    fn settled_input(&self, value: f32, hold: Hold) -> [f32; M] {
        either!(self, t => t.settled_input(value, hold))
    }
    fn output(&self, memory: &mut [f32; M], y: f32) -> Trends<M> {
        either!(self, t => t.output(memory, y))
    }
    fn movement(&self, memory: &mut [f32; M], y: f32, before: f32) -> Trends<M> {
        either!(self, t => t.movement(memory, y, before))
    }
    fn input(&self, memory: &mut [f32; M], u: f32, hold: Hold) -> [f32; M] {
        either!(self, t => t.input(memory, u, hold))
    }
    fn lead(&self) -> Trends<M> {
        either!(self, t => t.lead())
    }
    fn gain(&self, bandwidth: f32) -> f32 {
        either!(self, t => t.gain(bandwidth))
    }
    fn filter_polynomial(&self) -> Option<[f32; M]> {
        either!(self, t => t.filter_polynomial())
    }
    fn noise_gain(&self) -> NoiseGain<M> {
        either!(self, t => t.noise_gain())
    }
    fn decay(&self) -> f32 {
        either!(self, t => t.decay())
    }
    fn inexact(&self, found: &[f32; M]) -> f32 {
        either!(self, t => t.inexact(found))
    }
    fn continuous(&self, found: &[f32; M], integrators: usize) -> Option<Image<M>> {
        either!(self, t => t.continuous(found, integrators))
    }
    fn sampled(&self, a: &[f32; M], integrators: usize) -> Option<Image<M>> {
        either!(self, t => t.sampled(a, integrators))
    }
    fn warm_up(&self) -> u32 {
        either!(self, t => t.warm_up())
    }
}

fn polynomial<const M: usize>(coefficients: &[f32]) -> Result<[f32; M], ConfigError> {
    coefficients
        .try_into()
        .map_err(|_| ConfigError::ParameterCount {
            found: coefficients.len(),
            expected: M,
        })
}

fn sized<const M: usize>(setup: &Setup) -> Result<Box<dyn Recursion>, ConfigError> {
    let trends = match &setup.filter {
        Filter::None => AnyTrends::Raw(RawTrends::<M>::try_new(setup.scheme, setup.sample_time)?),
        Filter::Polynomial(f) => AnyTrends::Filtered(FilteredTrends::from_polynomial(
            setup.scheme,
            setup.sample_time,
            polynomial(f)?,
        )?),
        Filter::Exact { filter, model } => AnyTrends::Exact(
            ExactTrends::from_polynomial(setup.sample_time, polynomial(filter)?)?
                .with_model(polynomial(model)?)?,
        ),
    };
    macro_rules! dispatch {
        ($($n:literal)+) => {
            match setup.parameters() {
                $($n => Ok(Box::new(
                    Identifier::<_, M, $n, INPUTS, DELAY>::try_new(&setup.config::<M, $n>()?, trends)?,
                )),)+
                found => Err(ConfigError::ParameterCount { found, expected: PARAMETERS }),
            }
        };
    }
    dispatch!(1 2 3 4 5 6 7 8 9 10)
}

/// An [`Identifier`] of any size.
pub trait Recursion {
    /// Takes the inputs u(k) and y(k); missing inputs count as 0.
    fn update(&mut self, u: &[f32], y: f32) -> Outcome;
    /// The parameters in the order of the structure.
    fn theta(&self) -> Vec<f32>;
    /// Their standard deviations.
    fn std(&self) -> Vec<f32>;
    /// Covariance of the parameters.
    fn covariance(&self) -> Vec<Vec<f32>>;
    /// Standard deviations of gain, omega0, damping.
    fn physical_std(&self) -> Option<[f32; 3]>;
    /// a_0 .. a_{m-1}.
    fn a(&self) -> Vec<f32>;
    /// b_0 .. b_{m-1} of an input.
    fn b(&self, input: usize) -> Vec<f32>;
    /// The constant.
    fn constant(&self) -> f32;
    /// Gain, omega0, damping, time constants and stability of an input.
    fn physical(&self, input: usize) -> Reading;
    /// IQ and IV so far.
    fn quality(&self) -> Quality;
    /// Standard deviation of the innovation.
    fn noise_std(&self) -> Option<f32>;
    /// The newest one-step prediction of y.
    fn prediction(&self) -> f32;
    /// Lets the estimate move or holds it.
    fn adapt(&mut self, on: bool);
    /// Begins again from an estimate with its standard deviations.
    ///
    /// # Errors
    /// The value that is not finite, or a length that is not the structure's.
    fn warm_start(&mut self, theta: &[f32], std: &[f32]) -> Result<(), ConfigError>;
}

/// [`Physical`] without its size.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Static or velocity gain.
    pub gain: Option<f32>,
    /// Natural frequency in rad/s.
    pub omega0: Option<f32>,
    /// Damping ratio.
    pub damping: Option<f32>,
    /// Time constants of the real poles in s.
    pub time_constants: Vec<f32>,
    /// Poles (re, im) in rad/s, where the iteration settled.
    pub poles: Option<Vec<(f32, f32)>>,
    /// Whether the poles behind the integrators are stable.
    pub stable: bool,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize> Recursion
    for Identifier<T, M, N, INPUTS, DELAY>
{
    fn update(&mut self, u: &[f32], y: f32) -> Outcome {
        let mut inputs = [0.0; INPUTS];
        for (slot, u) in inputs.iter_mut().zip(u) {
            *slot = *u;
        }
        self.update_inputs(inputs, y)
    }

    fn theta(&self) -> Vec<f32> {
        Identifier::theta(self).to_vec()
    }

    fn std(&self) -> Vec<f32> {
        Identifier::std(self).to_vec()
    }

    fn covariance(&self) -> Vec<Vec<f32>> {
        Identifier::covariance(self)
            .map(|row| row.to_vec())
            .to_vec()
    }

    fn physical_std(&self) -> Option<[f32; 3]> {
        Identifier::physical_std(self)
    }

    fn a(&self) -> Vec<f32> {
        self.transfer_function().a.to_vec()
    }

    fn b(&self, input: usize) -> Vec<f32> {
        self.transfer_function()
            .b
            .get(input)
            .map(|b| b.to_vec())
            .unwrap_or_default()
    }

    fn constant(&self) -> f32 {
        self.transfer_function().constant
    }

    fn physical(&self, input: usize) -> Reading {
        let transfer: TransferFunction<M, INPUTS> = self.transfer_function();
        let reading = Physical::of(&transfer, input);
        Reading {
            gain: reading.gain,
            omega0: reading.omega0,
            damping: reading.damping,
            time_constants: reading.time_constants.into_iter().flatten().collect(),
            poles: transfer
                .poles()
                .map(|poles| poles.iter().map(|p| (p.re, p.im)).collect()),
            stable: reading.stable,
        }
    }

    fn quality(&self) -> Quality {
        Identifier::quality(self)
    }

    fn noise_std(&self) -> Option<f32> {
        Identifier::noise_std(self)
    }

    fn prediction(&self) -> f32 {
        Identifier::prediction(self)
    }

    fn adapt(&mut self, on: bool) {
        Identifier::adapt(self, on);
    }

    fn warm_start(&mut self, theta: &[f32], std: &[f32]) -> Result<(), ConfigError> {
        let count = |found| ConfigError::ParameterCount { found, expected: N };
        let theta = theta.try_into().map_err(|_| count(theta.len()))?;
        let std = std.try_into().map_err(|_| count(std.len()))?;
        Identifier::warm_start(self, theta, std)
    }
}
