//! The adaptive position loop on simulated axes, and the pneumatic axis itself.
//!
//! Claims over many runs are in `tests/statistics`. Tests that take seconds run in
//! `cargo xtask host`, which has the feature `thorough`.

mod both_ways;
mod braked;
mod changed;
mod ends;
mod faults;
mod gaps;
mod handling;
mod linearised;
mod machine;
mod nominal;
mod pneumatic;
mod pneumatic_linear;
mod population;
mod position_loop;
mod reconfigured;
mod requests;
mod resumed;
mod settings;
mod shadow;
mod skipped;
mod stored;
mod units;
mod very_ends;
