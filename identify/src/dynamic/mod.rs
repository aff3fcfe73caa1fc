//! The core behind sizes that are known only at run time.
//!
//! The core fixes its sizes at compile time. A program that reads records does not know
//! them, so this file instantiates the core for every order with some numbers of parameters
//! ([`padding`] fills up to the next one) and hides the choice behind a trait object. It
//! computes nothing itself.

mod padding;
mod sized;

use trendid::estimation::Terms;
use trendid::model::PredictionError;
use trendid::trends::Scheme;
use trendid::{Config, ConfigError, Outcome, Structure};

use crate::dynamic::padding::Padding;
use crate::dynamic::sized::sized;
use crate::estimate::Estimate;

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

/// The cores that are instantiated, by order and number of parameters.
macro_rules! sizes {
    ($($order:literal: $($parameters:literal)+;)+) => {
        /// Numbers of parameters, by order.
        const SIZES: [&[usize]; 4] = [$(&[$($parameters),+]),+];

        fn of_size(setup: &Setup, padding: Padding) -> Result<Box<dyn Recursion>, ConfigError> {
            match (setup.order, padding.size()) {
                $($(($order, $parameters) => sized::<$order, $parameters>(setup, padding),)+)+
                (_, found) => Err(ConfigError::ParameterCount { found, expected: PARAMETERS }),
            }
        }
    };
}

// Each costs a second of a processor in a build. The servo's own numbers stand for themselves, and those without room for
// padding: b_0 of four inputs of order 1, eight b_i of order 2.
sizes! {
    1: 2 4 5 6 7;
    2: 3 4 6 8 9 10;
    3: 3 4 5 6 8 10;
    4: 5 6 8 10;
}

impl Setup {
    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        let numerators: usize = self.inputs.iter().map(|terms| terms.count()).sum();
        let others = usize::from(self.constant) + usize::from(self.initial_state);
        self.output.count() + numerators + others
    }

    /// Builds the core for this setup: that of its number of parameters or of the next larger one that there is, with the
    /// surplus known to be 0. Without a memory the numbers are the same; with one they differ by what an observation of a
    /// nominal value counts, and the shortest memory is that of the larger core.
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
        if self.inputs.iter().all(|terms| terms.count() == 0) {
            return Err(ConfigError::NoInput);
        }
        of_size(self, self.padding()?)
    }

    /// To the smallest core that has room.
    fn padding(&self) -> Result<Padding, ConfigError> {
        let sizes = self.order.checked_sub(1).and_then(|order| SIZES.get(order));
        let sizes = sizes.ok_or(ConfigError::OutOfRange {
            setting: "order".into(),
            value: self.order as f32,
            limits: [1.0, 4.0],
        })?;
        let (found, expected) = (self.parameters(), PARAMETERS);
        let padding = sizes.iter().find_map(|size| Padding::to(self, *size));
        padding.ok_or(ConfigError::ParameterCount { found, expected })
    }
}

/// An [`Identifier`](trendid::Identifier) of any size.
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
