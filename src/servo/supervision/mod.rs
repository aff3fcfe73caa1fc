//! Which model may control: excitation, screening, validation, states.

mod adapting;
pub(crate) mod bank;
pub(crate) mod change;
pub(crate) mod comparison;
pub(crate) mod event;
pub(crate) mod evidence;
pub(crate) mod excitation_monitor;
mod known;
pub(crate) mod screening;
pub(crate) mod state;
pub(crate) mod supervisor;
pub(crate) mod unknown;
pub(crate) mod validation;
