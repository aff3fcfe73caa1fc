//! Meaning of the parameters: transfer function, physical reading, output evaluation.

pub(crate) mod evaluation;
pub(crate) mod physical;
pub(crate) mod transfer_function;

pub use evaluation::{OutputEvaluation, PredictionError};
pub use physical::Physical;
pub use transfer_function::{Pole, TransferFunction};
