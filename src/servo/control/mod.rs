//! What the valve shall do: observer and state feedback on a verified model.

pub(crate) mod controller;
pub(crate) mod observer;
