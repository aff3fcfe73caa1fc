//! The program from end to end.

mod commands;
mod common;
mod demo;
mod paper;
mod records;
mod records_spread;
mod refusals;
mod reports;
mod simulated;
mod valve_records;
