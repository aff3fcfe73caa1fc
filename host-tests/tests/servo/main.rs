//! The adaptive position loop on simulated axes, and the pneumatic axis itself.
//!
//! Claims over many runs are in `tests/statistics`.

mod changed;
mod faults;
mod handling;
mod linearised;
mod nominal;
mod pneumatic;
mod pneumatic_linear;
mod population;
mod position_loop;
mod reconfigured;
mod settings;
mod shadow;
mod skipped;
mod stored;
