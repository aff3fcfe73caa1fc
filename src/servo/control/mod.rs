//! Control on a verified model: poles from margins, estimator over the delay, law, friction that
//! holds, rest, limits.

pub(crate) mod anchor;
pub(crate) mod axis_state;
pub(crate) mod compensator;
pub(crate) mod controller;
pub(crate) mod estimator;
pub(crate) mod friction;
mod gains;
pub(crate) mod holding;
mod hop;
mod law;
pub(crate) mod limiter;
pub(crate) mod load;
pub(crate) mod margins;
pub(crate) mod null;
mod observation;
pub(crate) mod observer;
#[cfg(test)]
mod oracle;
pub(crate) mod place;
pub(crate) mod poles;
mod push;
pub(crate) mod rest;
mod room;
mod standing;
pub(crate) mod sweep;
pub(crate) mod transfer;
pub(crate) mod tuning;

#[cfg(test)]
mod tests;
