//! What the parameters mean: transfer function, physical reading, output evaluation.

pub(crate) mod evaluation;
pub(crate) mod physical;
pub(crate) mod transfer_function;
