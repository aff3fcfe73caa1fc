//! What is asked of a core: a structure, its trends, settings.

use trendid::estimation::Terms;
use trendid::trends::Scheme;
use trendid::{Config, Structure};

/// Most inputs that a run-time structure can have.
pub const INPUTS: usize = 4;
/// Longest delay in samples.
pub const DELAY: usize = 512;
/// Most parameters.
pub const PARAMETERS: usize = 10;

/// The settings of the core for up to [`INPUTS`] inputs, made by [`settings`].
///
/// The sizes are placeholders until [`Setup::build`] knows the structure, so `structure`, `initial`
/// and `prior_std` are without effect;
/// [`Recursion::warm_start`](crate::dynamic::Recursion::warm_start) begins from known parameters.
pub type Settings = Config<1, INPUTS, INPUTS>;

/// The core's defaults for a plant of this bandwidth \[rad/s\] and these sizes of signals, see
/// [`Config::new`]. Inputs beyond [`INPUTS`] are left out; [`Setup::build`] refuses them.
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

impl Setup {
    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        let numerators: usize = self.inputs.iter().map(|terms| terms.count()).sum();
        let others = usize::from(self.constant) + usize::from(self.initial_state);
        self.output.count() + numerators + others
    }
}
