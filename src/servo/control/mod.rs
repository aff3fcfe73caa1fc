//! Control on a verified model: law, observer, friction that sticks, standstill, limits of the command.

pub(crate) mod controller;
pub(crate) mod friction;
pub(crate) mod limiter;
pub(crate) mod observer;
pub(crate) mod standstill;
