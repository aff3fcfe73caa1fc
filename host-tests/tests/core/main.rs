//! The core against oracles in f64 and known plants: what every change is checked by.
//!
//! Claims over hundreds of records are in `tests/statistics`.

mod common;

mod accuracy;
mod batch;
mod bound;
mod calibration;
mod chain;
mod dead_zone;
mod defects;
mod delay;
mod endurance;
mod evaluation;
mod exact;
mod faults;
mod forgetting;
mod integral;
mod oracle;
mod properties;
mod rest;
mod retune;
mod robustness;
mod store;
mod transfer;
mod valve;
