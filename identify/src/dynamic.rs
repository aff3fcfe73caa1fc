//! The core behind sizes that are known only at run time.
//!
//! The core fixes its sizes at compile time. A program that reads records does not know
//! them, so this file instantiates the core for every order and number of parameters it
//! offers and hides the choice behind a trait object. It computes nothing itself.

use trendid::estimation::Terms;
use trendid::model::{Physical, PredictionError};
use trendid::trends::{AnyTrends, ExactTrends, FilteredTrends, RawTrends, Scheme, TrendOperator};
use trendid::{Config, ConfigError, Identifier, Outcome, Structure};

use crate::estimate::{Estimate, Reading};

/// Most inputs that a run-time structure can have.
pub const INPUTS: usize = 4;
/// Longest delay in samples.
pub const DELAY: usize = 512;
/// Most parameters.
pub const PARAMETERS: usize = 10;

/// The settings of the core for up to [`INPUTS`] inputs, made by [`settings`].
///
/// The sizes are placeholders until [`Setup::build`] knows the structure, so `structure`, `initial` and `prior_std`
/// are without effect; [`Recursion::warm_start`] begins from known parameters.
pub type Settings = Config<1, INPUTS, INPUTS>;

/// The core's defaults for a plant of this bandwidth \[rad/s\] and these sizes of signals, see [`Config::new`].
/// Inputs beyond [`INPUTS`] are left out; [`Setup::build`] refuses them.
pub fn settings(bandwidth: f32, input_ranges: &[f32], output_range: f32) -> Settings {
    let mut ranges = [1.0; INPUTS];
    for (slot, range) in ranges.iter_mut().zip(input_ranges) {
        *slot = *range;
    }
    Config::new(Structure::INTEGRATING, bandwidth, ranges, output_range)
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

/// A structure and its trends with sizes as values, and the settings of the core.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Order m, 1..=4.
    pub order: usize,
    /// Which a_i exist.
    pub output: Terms,
    /// Which b_i exist, for each of at most [`INPUTS`] inputs.
    pub inputs: Vec<Terms>,
    /// Whether there is a constant input.
    pub constant: bool,
    /// Whether the initial state is a parameter.
    #[doc(alias = "start")]
    pub initial_state: bool,
    /// Sampling interval \[s\].
    pub sample_time: f32,
    /// Goodwin or Tustin.
    pub scheme: Scheme,
    /// Raw or filtered trends.
    pub filter: Filter,
    /// Everything else.
    pub settings: Settings,
}

/// The core of each order with each number of parameters that a structure of this order can have.
macro_rules! by_size {
    ($setup:expr; $($order:literal: $($parameters:literal)+;)+) => {
        match ($setup.order, $setup.parameters()) {
            $($(($order, $parameters) => sized::<$order, $parameters>($setup),)+)+
            (1..=4, found) => Err(ConfigError::ParameterCount { found, expected: PARAMETERS }),
            (order, _) => Err(ConfigError::OutOfRange {
                setting: "order".into(),
                value: order as f32,
                limits: [1.0, 4.0],
            }),
        }
    };
}

impl Setup {
    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        let numerators: usize = self.inputs.iter().map(|terms| terms.count()).sum();
        let others = usize::from(self.constant) + usize::from(self.initial_state);
        self.output.count() + numerators + others
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
        // Of order 1 there are a_0, a b_0 of each input, the constant and the initial state.
        by_size! { self;
            1: 1 2 3 4 5 6 7;
            2: 1 2 3 4 5 6 7 8 9 10;
            3: 1 2 3 4 5 6 7 8 9 10;
            4: 1 2 3 4 5 6 7 8 9 10;
        }
    }

    fn config<const M: usize, const N: usize>(&self) -> Result<Config<M, N, INPUTS>, ConfigError> {
        let mut inputs = [Terms::NONE; INPUTS];
        inputs[..self.inputs.len()].copy_from_slice(&self.inputs);
        let structure = if self.initial_state {
            Structure::try_with_initial_state(self.output, inputs, self.constant)?
        } else {
            Structure::try_new(self.output, inputs, self.constant)?
        };
        Ok(self.settings.with_structure(structure))
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

fn trends<const M: usize>(setup: &Setup) -> Result<AnyTrends<M>, ConfigError> {
    Ok(match &setup.filter {
        Filter::None => AnyTrends::Raw(RawTrends::try_new(setup.scheme, setup.sample_time)?),
        Filter::Polynomial(f) => AnyTrends::Filtered(FilteredTrends::from_polynomial(
            setup.scheme,
            setup.sample_time,
            polynomial(f)?,
        )?),
        Filter::Exact { filter, model } => AnyTrends::Exact(
            ExactTrends::from_polynomial(setup.sample_time, polynomial(filter)?)?
                .with_model(polynomial(model)?)?,
        ),
    })
}

fn sized<const M: usize, const N: usize>(setup: &Setup) -> Result<Box<dyn Recursion>, ConfigError> {
    Ok(Box::new(Sized::<_, M, N> {
        identifier: Identifier::try_new(&setup.config::<M, N>()?, trends(setup)?)?,
        numerators: setup
            .inputs
            .iter()
            .map(|terms| numerators(*terms, M))
            .collect(),
    }))
}

/// An [`Identifier`] of any size.
pub trait Recursion: Send + Sync {
    /// Takes the inputs u(k) and y(k); missing inputs count as 0.
    fn update(&mut self, u: &[f32], y: f32) -> Outcome;
    /// The model at this moment.
    fn estimate(&self) -> Estimate;
    /// The parameters of [`estimate`](Self::estimate) alone, at about a tenth of its cost; as many as there is room for.
    fn theta(&self, to: &mut [f32]);
    /// Sums of the squared and of the absolute prediction errors so far.
    fn prediction_error(&self) -> PredictionError;
    /// Lets the estimate move or holds it.
    fn adapt(&mut self, on: bool);
    /// Begins again from an estimate with its standard deviations.
    ///
    /// # Errors
    /// The value that is not finite, or a length that is not the structure's.
    fn warm_start(&mut self, theta: &[f32], std: &[f32]) -> Result<(), ConfigError>;
}

/// The core with the numbers of numerator coefficients of its inputs.
struct Sized<T: TrendOperator<M>, const M: usize, const N: usize> {
    identifier: Identifier<T, M, N, INPUTS, DELAY>,
    numerators: Vec<usize>,
}

impl<T, const M: usize, const N: usize> Recursion for Sized<T, M, N>
where
    T: TrendOperator<M, Memory: Send + Sync> + Send + Sync,
{
    fn update(&mut self, u: &[f32], y: f32) -> Outcome {
        let mut inputs = [0.0; INPUTS];
        for (slot, u) in inputs.iter_mut().zip(u) {
            *slot = *u;
        }
        self.identifier.update_inputs(inputs, y)
    }

    fn estimate(&self) -> Estimate {
        let found = self.identifier.estimate();
        let transfer = found.transfer_function();
        let reading = Physical::of(&transfer, 0);
        let poles = transfer.poles();
        Estimate {
            theta: wide(&found.theta()),
            sigma: wide(&found.std()),
            covariance: found.covariance().map(|row| wide(&row)).to_vec(),
            a: wide(&transfer.a),
            b: transfer
                .b
                .iter()
                .zip(&self.numerators)
                .map(|(b, n)| wide(&b[..*n]))
                .collect(),
            constant: f64::from(transfer.constant),
            reading: Reading {
                gain: reading.gain.map(f64::from),
                omega0: reading.omega0.map(f64::from),
                damping: reading.damping.map(f64::from),
                time_constants: wide(
                    &reading
                        .time_constants
                        .into_iter()
                        .flatten()
                        .collect::<Vec<_>>(),
                ),
                poles: poles.map(|poles| {
                    let wide = |p: &trendid::model::Pole| (f64::from(p.re), f64::from(p.im));
                    poles.iter().map(wide).collect()
                }),
                stable: reading.stable,
            },
            reading_sigma: found.physical_std().map(|s| s.map(f64::from)),
        }
    }

    fn theta(&self, to: &mut [f32]) {
        for (to, theta) in to.iter_mut().zip(self.identifier.theta()) {
            *to = theta;
        }
    }

    fn prediction_error(&self) -> PredictionError {
        self.identifier.prediction_error()
    }

    fn adapt(&mut self, on: bool) {
        self.identifier.adapt(on);
    }

    fn warm_start(&mut self, theta: &[f32], std: &[f32]) -> Result<(), ConfigError> {
        let count = |found| ConfigError::ParameterCount { found, expected: N };
        let theta = theta.try_into().map_err(|_| count(theta.len()))?;
        let std = std.try_into().map_err(|_| count(std.len()))?;
        self.identifier.warm_start(theta, std)
    }
}

/// One more than the highest power of a numerator.
fn numerators(terms: Terms, order: usize) -> usize {
    (0..order)
        .rev()
        .find(|power| terms.contains(*power))
        .map_or(0, |power| power + 1)
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().copied().map(f64::from).collect()
}
