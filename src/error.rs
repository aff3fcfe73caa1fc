//! What can be wrong with a configuration; each value is named.

use core::fmt;

/// A configuration that cannot work, with the offending value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConfigError {
    /// The structure has `found` parameters, the type has room for exactly `expected`.
    ParameterCount {
        /// Number of parameters the terms add up to.
        found: usize,
        /// The const parameter `N`.
        expected: usize,
    },
    /// A term `a_i` or `b_i` with `i >= m` was asked for.
    Term {
        /// The power of s of the term.
        power: usize,
        /// The order of the model.
        order: usize,
    },
    /// No input has a numerator term.
    NoInput,
    /// The sample time is not a positive finite number of seconds.
    SampleTime(f32),
    /// A filter pole (as a positive rate in rad/s) or filter coefficient is not usable.
    FilterPole {
        /// Position in the list.
        index: usize,
        /// The value given.
        value: f32,
    },
    /// The bandwidth is not a positive finite number of rad/s.
    Bandwidth(f32),
    /// The range of an input is not positive and finite.
    InputRange {
        /// Which input.
        input: usize,
        /// The value given.
        value: f32,
    },
    /// The range of the output is not positive and finite.
    OutputRange(f32),
    /// The noise level expected on the output is not positive and finite.
    NoiseStd(f32),
    /// The memory is not longer than two samples (seconds).
    Memory(f32),
    /// An initial estimate is not finite.
    Initial {
        /// Position in theta.
        index: usize,
        /// The value given.
        value: f32,
    },
    /// A prior standard deviation is negative or not finite.
    PriorStd {
        /// Position in theta.
        index: usize,
        /// The value given.
        value: f32,
    },
    /// A delay is longer than the delay line.
    Delay {
        /// Which input.
        input: usize,
        /// Samples asked for.
        samples: usize,
        /// The const parameter `D`.
        capacity: usize,
    },
    /// The weight of the pull toward the trusted estimate is negative or not finite.
    Pull(f32),
    /// The doubt of a constant is negative or not finite.
    Doubt(f32),
    /// The settling time is negative or not finite (seconds).
    Settling(f32),
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ParameterCount { found, expected } => write!(
                f,
                "the structure has {found} parameters, its type holds {expected}"
            ),
            Self::Term { power, order } => {
                write!(f, "a term of power {power} in a model of order {order}")
            }
            Self::NoInput => write!(f, "no input has a numerator term"),
            Self::SampleTime(v) => write!(f, "sample time {v} s is not positive"),
            Self::FilterPole { index, value } => write!(
                f,
                "filter pole {index} = {value} does not give a stable filter"
            ),
            Self::Bandwidth(v) => write!(f, "bandwidth {v} rad/s is not positive"),
            Self::InputRange { input, value } => {
                write!(f, "range {value} of input {input} is not positive")
            }
            Self::OutputRange(v) => write!(f, "output range {v} is not positive"),
            Self::NoiseStd(v) => write!(f, "output noise {v} is not positive"),
            Self::Memory(v) => write!(f, "memory {v} s is not longer than two samples"),
            Self::Initial { index, value } => {
                write!(f, "initial estimate {index} = {value} is not finite")
            }
            Self::PriorStd { index, value } => write!(
                f,
                "prior standard deviation {index} = {value} is not a finite number >= 0"
            ),
            Self::Delay {
                input,
                samples,
                capacity,
            } => write!(
                f,
                "delay {samples} of input {input} exceeds the delay line of {capacity} samples"
            ),
            Self::Pull(v) => write!(f, "pull weight {v} is not a finite number >= 0"),
            Self::Doubt(v) => write!(f, "doubt {v} is not a finite number >= 0"),
            Self::Settling(v) => write!(f, "settling time {v} s is not a finite number >= 0"),
        }
    }
}

impl core::error::Error for ConfigError {}

/// The orders that the trends and the structures are made for, checked at compile time.
pub(crate) const fn assert_order(order: usize) {
    assert!(1 <= order && order <= 4, "the order M is not in 1..=4");
}

/// Whether `value` is a finite number above zero.
pub(crate) const fn positive(value: f32) -> bool {
    value > 0.0 && value <= f32::MAX
}
