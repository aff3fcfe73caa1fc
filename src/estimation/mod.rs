//! Estimation: from trends to parameters by recursive least squares.

pub(crate) mod noise_level;
pub(crate) mod regressor;
pub(crate) mod rls;
pub(crate) mod structure;
pub(crate) mod terms;
