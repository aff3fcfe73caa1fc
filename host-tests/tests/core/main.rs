//! The core against oracles in f64 and known plants: what every change is checked by.
//!
//! Claims over hundreds of records are in `tests/statistics`. Tests that take seconds run in
//! `cargo xtask host`, which has the feature `thorough`.

mod common;

mod accuracy;
// With `thorough` alone: dozens of shapes of the core, each a second of a processor to build.
#[cfg(feature = "thorough")]
mod attack;
mod batch;
mod batches;
mod beginning;
mod bound;
mod calibration;
mod chain;
mod changes;
mod copied;
mod counters;
mod dead_zone;
mod defects;
mod delay;
mod dense;
mod digits;
mod endurance;
mod evaluation;
#[cfg(feature = "thorough")]
mod exact;
mod far;
mod faults;
mod flash;
mod forgetting;
mod honest;
#[cfg(feature = "thorough")]
mod instrument_populations;
mod instruments;
mod integral;
mod memory;
mod nominal;
mod nothing_seen;
mod oracle;
mod planes;
mod properties;
mod records;
mod reset;
mod rest;
mod retune;
mod robustness;
mod roots;
mod settings;
mod sticks;
mod store;
mod transfer;
mod units;
mod valve;
