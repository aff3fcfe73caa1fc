//! Estimation: from trends to parameters by recursive least squares.

pub(crate) mod beginning;
mod factors;
pub(crate) mod forgetting;
mod inflation;
pub(crate) mod mean_square;
pub(crate) mod noise_level;
pub(crate) mod postponed;
pub(crate) mod regressor;
pub(crate) mod rls;
pub(crate) mod start_error;
pub(crate) mod structure;
pub(crate) mod terms;
mod two_words;

pub use forgetting::StabilisedForgetting;
pub use noise_level::NoiseLevel;
pub use rls::Estimator;
pub use structure::Structure;
pub use terms::{Parameter, Terms};
