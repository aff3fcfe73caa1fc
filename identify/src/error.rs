//! Why a record cannot be identified, as values that name what is wrong.

use thiserror::Error;
use trendid::ConfigError;

use crate::dynamic::{INPUTS, PARAMETERS};

/// Errors of the signals, the structure or the options.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A column has not as many samples as the output.
    #[error("`{name}` has {found} samples, the output {expected}")]
    Length {
        /// Name of the input.
        name: String,
        /// Its samples.
        found: usize,
        /// Samples of the output.
        expected: usize,
    },
    /// A sample is NaN or infinite.
    #[error("sample {sample} of {name} is {value}, not a finite number")]
    NotFinite {
        /// The input in quotation marks, or "the output".
        name: String,
        /// Index from 0.
        sample: usize,
        /// The value.
        value: f64,
    },
    /// The sampling interval is not a positive number of seconds.
    #[error("the sampling interval {0} s is not a positive number")]
    SampleTime(f64),
    /// The order is not offered.
    #[error("the order {0} is not one of 1, 2, 3, 4")]
    Order(usize),
    /// As many zeros as poles, or more.
    #[error("{}, not {order}", needing(*zeros))]
    Zeros {
        /// Zeros asked for.
        zeros: usize,
        /// Order asked for.
        order: usize,
    },
    /// No input, or more than [`INPUTS`].
    #[error("{0} inputs were asked for, at most {INPUTS} are possible")]
    Inputs(usize),
    /// More than [`PARAMETERS`].
    #[error("the structure has {0} parameters, at most {PARAMETERS} are possible")]
    Parameters(usize),
    /// Fewer than ten samples for each parameter.
    #[error(
        "too few samples: {found} for {parameters} parameter{}, at least {needed} are needed", plural(*parameters)
    )]
    TooFewSamples {
        /// Samples of the record.
        found: usize,
        /// Parameters of the structure.
        parameters: usize,
        /// Samples that they need.
        needed: usize,
    },
    /// An input is the same number throughout.
    #[error(
        "the input `{name}` never changes over the {samples} samples: nothing excites the plant"
    )]
    InputConstant {
        /// Its name.
        name: String,
        /// Samples of the record.
        samples: usize,
    },
    /// The output is the same number throughout.
    #[error("the output never changes over the {samples} samples: there is nothing to identify")]
    OutputConstant {
        /// Samples of the record.
        samples: usize,
    },
    /// The memory is too short or not finite.
    #[error("{}", of_memory(*memory, *shortest))]
    Memory {
        /// The memory asked for \[s\].
        memory: f64,
        /// Two samples \[s\].
        shortest: f64,
    },
    /// A sample that the core refuses.
    #[error("sample {0} is out of all proportion to the rest of the record")]
    Disproportionate(usize),
    /// The samples do not separate the parameters of a structure.
    #[error(
        "the data cannot carry a model of order {order} with {parameters} parameter{}: {weakness}", plural(*parameters)
    )]
    CannotCarry {
        /// Order of the model.
        order: usize,
        /// Its parameters.
        parameters: usize,
        /// The missing item.
        weakness: Weakness,
    },
    /// One sine as the input, and more unknowns than its gain and its phase.
    #[error(
        "not identifiable, because one sine as the input fixes two numbers, its gain and its phase, and {unknowns} are unknown with the delay: give the delay, or excite with more than one frequency"
    )]
    OneSine {
        /// The delay and the parameters but the constant.
        unknowns: usize,
    },
    /// One sine as the input, and a structure that is searched with its delay.
    #[error(
        "no structure is identifiable, because one sine as the input fixes two numbers, its gain and its phase: excite with more than one frequency, or give the delay"
    )]
    OneSineForAll,
    /// No structure passed.
    #[error("no structure of order 1 to {max_order} holds; {why}")]
    NoStructure {
        /// Highest order tried.
        max_order: usize,
        /// The commonest reason, with the number of structures.
        why: String,
    },
    /// A model that no controller is designed for.
    #[error("no controller for this model: {0}")]
    Model(String),
    /// Filter poles that the sampling does not carry.
    #[error(
        "filter poles at {pole} rad/s were asked for; below {fastest:.4} rad/s, half of the sampling frequency, are possible"
    )]
    Filter {
        /// Asked for \[rad/s\].
        pole: f64,
        /// The fastest \[rad/s\].
        fastest: f64,
    },
    /// A bandwidth that the sampling does not carry.
    #[error(
        "a bandwidth of {bandwidth} rad/s was asked for; above 0 and up to {fastest:.4} rad/s, half a radian per sample, is possible"
    )]
    Bandwidth {
        /// Asked for \[rad/s\].
        bandwidth: f64,
        /// The largest \[rad/s\].
        fastest: f64,
    },
    /// The core's own refusal.
    #[error(transparent)]
    Core(#[from] ConfigError),
}

/// What the word for more than one ends with.
const fn plural(count: usize) -> &'static str {
    match count {
        1 => "",
        _ => "s",
    }
}

/// What is wrong with a memory in s.
fn of_memory(memory: f64, shortest: f64) -> String {
    match memory.is_finite() {
        // In f32 without the rounding of the product.
        true => format!(
            "a memory of {memory} s is not longer than two samples ({} s)",
            shortest as f32
        ),
        false => {
            format!("a memory of {memory} s is no finite time: without one nothing is forgotten")
        }
    }
}

/// What may be wrong with a structure whose models are unstable.
const fn otherwise(integrator: bool) -> &'static str {
    match integrator {
        true => {
            "order, zeros or delay are others, or no input drives the output: try --delay auto, or `trendid select`"
        }
        false => "try --integrator, or `trendid select`",
    }
}

/// The order that so many zeros need.
fn needing(zeros: usize) -> String {
    match zeros {
        1 => "1 zero needs an order of at least 2".into(),
        2 | 3 => format!("{zeros} zeros need an order of at least {}", zeros + 1),
        _ => format!("{zeros} zeros need a higher order than 4, the highest that is possible"),
    }
}

/// How a structure fails on a record.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Weakness {
    /// NaN or infinite parameters.
    #[error("the estimate is not finite")]
    NotFinite,
    /// Equations without a solution.
    #[error(
        "the equations are singular: the inputs excite too little, or two signals say the same"
    )]
    Singular,
    /// A parameter with an undefined correlation.
    #[error("a parameter has no influence on the output")]
    NoInfluence,
    /// A singular correlation of these parameters.
    #[error("{} cannot be told apart", .0.join(", "))]
    Inseparable(Vec<String>),
    /// A delay with a deviation beyond what the equations are linear over.
    #[error(
        "its delay cannot be told from its parameters, because three deviations of it are longer than the fastest time constant: give the delay, or excite more often"
    )]
    Delay,
    /// No model of the search can be simulated.
    #[error(
        "each one, or one without an eighth of the record, is unstable: {}", otherwise(*integrator)
    )]
    NoSimulation {
        /// Whether the structure integrates already.
        integrator: bool,
    },
    /// The prediction of held-out samples is not finite.
    #[error("its prediction of the second half is not finite")]
    NoPrediction,
}
