//! Which model may control: excitation, validation, states.

pub(crate) mod config;
pub(crate) mod excitation;
pub(crate) mod excitation_monitor;
pub(crate) mod state;
pub(crate) mod supervisor;
pub(crate) mod validation;
