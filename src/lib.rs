//! Recursive identification of low-order continuous-time models of servo drives.
//!
//! Once per sample `trendid` takes the command `u` and the position `y` of a drive and
//! updates the parameters a_i, b_i of its transfer function
//!
//! ```text
//! G(s) = (b_{m-1} s^{m-1} + .. + b_0) / (s^m + a_{m-1} s^{m-1} + .. + a_0) e^{-s d Delta}     (1)
//! ```
//!
//! directly, in SI units, with their standard deviations. It does not differentiate
//! and does not go through a discrete-time model: *trends* (Goodwin's delta operator
//! or the modified Tustin transformation, K. Janiszowski 1999) of the samples take the
//! place of derivatives, and recursive least squares in U D U' form finds the
//! parameters. `no_std`, f32, fixed size, no allocation, no unsafe code.
//!
//! # The data flow is the list of modules
//!
//! ```text
//! samples -> ring buffers -> trends (raw or filtered) -> regressor -> estimator -> transfer function -> physical reading
//!                                                                          `-> prediction, IQ and IV
//! ```
//!
//! | room | type | what it does |
//! |---|---|---|
//! | sample | [`DelayLine`] | checks a value, delays an input |
//! | trend, raw, filter, chain, warp, numerators, exact, integral | [`TrendOperator`], [`RawTrends`], [`FilteredTrends`], [`ExactTrends`], [`IntegralTrends`] | equations (4), (8) |
//! | structure, regressor | [`Structure`], [`Terms`] | which parameters, their signs, order and scales (5), (12) |
//! | estimator | [`Estimator`] | recursive least squares |
//! | noise, readout, doubt, shaping, continuous | [`NoiseLevel`] | noise bias out of theta, a constant that nothing shows withdrawn, standard deviations |
//! | transfer, physical | [`TransferFunction`], [`Physical`] | what theta means |
//! | evaluation | [`OutputEvaluation`], [`PredictionError`] | (9)-(11) |
//! | config, outcome, identifier | [`Config`], [`Outcome`], [`Identifier`] | all of it behind one call per sample |
//! | inputs | [`DeadZone`], [`asymmetric`], [`coulomb`] | inputs for valves and friction |
//! | delay_bank | [`DelayBank`] | which delay the drive has, for commissioning |
//! | servo | [`servo::ServoLoop`], [`servo::Config`] | jerk-limited reference, pole placement on a verified model, supervision; the whole loop in one call per sample |
//! | hardware | [`hardware::PositionSensor`], [`hardware::Valve`] | the edge to sensors and valves: traits, drivers, scale |
//!
//! # Ten lines
//!
//! ```
#![doc = include_str!("../examples/first.rs")]
//! ```
//!
//! # Symbols
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | u, y | command, position | the user's |
//! | Delta | sample time | s |
//! | m, d | order, delay | -, samples |
//! | R_i, P_i | trends of y, of u | of the signal per s^i |
//! | phi, theta | regressor, parameters | - |
//! | lambda | forgetting | 1 - Delta/memory |
//! | e | innovation | of y |
//! | P = U D U' | covariance | of theta squared |
//! | C, omega0, xi | velocity gain, natural frequency, damping | y/s per u, rad/s, 1 |
//!
//! # Features
//!
//! | feature | adds |
//! |---|---|
//! | `defmt` | `defmt::Format` on the public types |
//!
//! A feature adds items and changes no number.
//!
//! # What it does not do
//!
//! It finds parameters, not structures: the user names the order, or lets the command
//! line tool compare them. It is not a safety function.

#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::disallowed_types)]

mod error;
mod estimation;
pub mod hardware;
mod identifier;
mod math;
mod model;
mod readout;
pub mod servo;
mod trends;

pub use error::{ConfigError, Setting};
pub use estimation::noise_level::NoiseLevel;
pub use estimation::rls::Estimator;
pub use estimation::structure::Structure;
pub use estimation::terms::{Parameter, Terms};
pub use identifier::Identifier;
pub use identifier::config::Config;
pub use identifier::delay_bank::DelayBank;
pub use identifier::inputs::{DeadZone, asymmetric, coulomb, dead_zone};
pub use identifier::outcome::{Outcome, Refusal};
pub use identifier::servo::{Servo, ValveServo};
pub use model::evaluation::{OutputEvaluation, PredictionError};
pub use model::physical::Physical;
pub use model::transfer_function::{Pole, TransferFunction};
pub use readout::estimate::Estimate;
pub use trends::{
    AnyMemory, AnyTrends, Chain, DelayLine, Design, ExactTrends, FilteredTrends, Form, Hold,
    IntegralTrends, Mapped, Memory, NoiseGain, RawTrends, Scheme, Span, TrendOperator, Trends,
    Window,
};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExamples;

/// The snippets of the design notes are tests.
#[cfg(doctest)]
#[doc = include_str!("../DESIGN.md")]
struct DesignExamples;
