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
//! samples -> trends (raw or filtered) -> regressor -> estimator -> read-out -> transfer function -> physical reading
//!                                                        `-> prediction and its errors
//! (u, y) -> identifier -> supervisor -> verified model -> controller -> valve                          (servo)
//! ```
//!
//! A module uses only modules that stand above it.
//!
//! | module | names | what it does |
//! |---|---|---|
//! | [`error`] | [`ConfigError`] | what is wrong with a configuration |
//! | `math` | - | polynomials, matrices, complex numbers; the only one that names libm |
//! | [`trends`] | [`trends::FilteredTrends`], [`trends::RawTrends`], [`trends::ExactTrends`] | what takes the place of derivatives, equations (4), (8); delays |
//! | [`estimation`] | [`Structure`], [`estimation::Estimator`] | which parameters, their signs and scales (5), (12); recursive least squares; noise level |
//! | [`model`] | [`TransferFunction`], [`model::Physical`] | what theta means; output evaluation (9)-(11) |
//! | `readout` | [`Estimate`] | noise bias taken out, an insignificant constant withdrawn, covariance |
//! | [`identifier`] | [`Identifier`], [`Config`], [`Outcome`], [`Servo`] | all of it behind one call per sample |
//! | [`batches`] | [`batches::Batched`] | standard deviations of least squares by batch means |
//! | [`instruments`] | [`instruments::Instrumented`] | estimates without the bias of noise, standard deviations by batch means |
//! | [`inputs`] | [`inputs::Valved`], [`inputs::DeadZone`], [`inputs::coulomb`] | inputs for valves and friction; an identifier behind a valve |
//! | [`hardware`] | [`hardware::PositionSensor`], [`hardware::Valve`] | the edge to sensors and valves: traits, drivers, scale |
//! | [`servo`] | [`servo::ServoLoop`], [`servo::Config`] | trajectory, pole placement on a verified model, supervision; the whole loop in one call per sample |
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

pub mod batches;
pub mod error;
pub mod estimation;
pub mod hardware;
pub mod identifier;
pub mod instruments;
mod math;
pub mod model;
mod readout;
pub mod servo;
pub mod trends;

pub use error::ConfigError;
pub use estimation::Structure;
pub use identifier::{Config, Identifier, Outcome, Servo, ValveServo, inputs};
pub use model::TransferFunction;
pub use readout::Estimate;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExamples;

/// The snippets of the design notes are tests.
#[cfg(doctest)]
#[doc = include_str!("../DESIGN.md")]
struct DesignExamples;
