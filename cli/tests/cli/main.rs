//! The program from end to end.

mod commands;
mod common;
mod dead_zones;
mod demo;
#[path = "../../../identify/tests/draws/mod.rs"]
mod draws;
mod empty_rows;
mod paper;
mod records;
mod records_spread;
mod refusals;
mod refusals_of_options;
mod refusals_of_values;
mod reports;
mod selected;
mod simulated;
mod stdin;
mod tuned;
mod users;
mod verdicts;
mod wrong_numbers;
