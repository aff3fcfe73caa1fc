//! Claims over hundreds of runs: accuracy, calibration of the reported deviations, comparison with
//! other estimators.
//!
//! Ignored in `cargo test`, which lists them as such. All of them, with what they print:
//!
//! ```text
//! cargo test --release -p trendid-host-tests --test statistics -- --ignored --nocapture
//! ```

mod bound_ratio;
mod calibration;
mod comparison;
mod drift_bound;
mod faults;
mod position_loop;
mod sampling;
mod table1;
