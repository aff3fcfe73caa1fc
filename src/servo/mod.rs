//! Adaptive position control: reference, control on a verified model, supervision, and the whole
//! loop in one call.
//!
//! ```text
//! sensor -> y -> [commissioning] excitation ------------------> limiter -> valve -> u
//!             `-> [control] trajectory -> controller --------'                  |
//! (u, y) -> identifier -> candidate -> supervisor -> verified model -> controller
//! ```
//!
//! | folder | task |
//! |---|---|
//! | config, design | settings of the user; every number that follows from them |
//! | model | what a commissioning finds and a controller controls on |
//! | motion | reference: moves, sine, run-out; the motion before there is a model |
//! | commissioning | the first model: rest, probe, relay, random levels, search |
//! | control | poles from margins, estimator over the delay, law, friction that holds, rest, limits of the command |
//! | supervision | excitation, screening and validation of models, states and reasons |
//! | monitoring | faults of sensor, valve and axis in control, and how they stop it |
//! | identification | the identifier of the loop and its candidates |
//! | servo_loop, supervise, protect | all of it behind one call per sample |
//! | tune, build, building | from a model to poles and to a loop that controls on it, in pieces of a sample |
//! | report, error | what a sample gives, and what settings and requests are refused for |
//! | store | a verified model in flash |

mod build;
pub(crate) mod building;
pub(crate) mod commissioning;
pub(crate) mod config;
pub(crate) mod control;
pub(crate) mod design;
pub(crate) mod error;
pub(crate) mod identification;
pub(crate) mod model;
pub(crate) mod monitoring;
pub(crate) mod motion;
mod protect;
pub(crate) mod report;
pub(crate) mod servo_loop;
pub mod store;
mod supervise;
pub(crate) mod supervision;
mod tune;

pub use config::{Config, ControllerSettings, ExcitationSettings, SupervisionSettings};
pub use control::controller::Controller;
pub use control::margins::Margins;
pub use design::Design;
pub use error::Error;
pub use identification::LoopIdentifier;
pub use model::Model;
pub use monitoring::FaultCounters;
pub use motion::{Motion, MotionLimits, Setpoint, Travel};
pub use report::Report;
pub use servo_loop::ServoLoop;
pub use supervision::state::{Reason, State};
pub use supervision::supervisor::Supervisor;
pub use supervision::validation::FitReport;

#[cfg(test)]
mod tests;
