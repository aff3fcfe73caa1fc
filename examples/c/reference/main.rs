//! The runs of `examples/c` in Rust, without the C interface: the lines that C must print; with
//! `octave` or `fmu` those of these edges.
//!
//! ```text
//! cargo run --release -p trendid-capi --example c-reference
//! ```
#![cfg(not(target_os = "none"))]

mod axis;
mod control;
mod fmu;
mod identify;
mod known;
mod octave;
mod outcome;
mod record;

use crate::record::Error;

/// The lines of `examples/c`.
fn all() -> Result<(), Error> {
    identify::identify()?;
    known::known()?;
    known::instruments()?;
    control::control()?;
    println!("refusals ok");
    Ok(())
}

fn main() -> Result<(), Error> {
    match std::env::args().nth(1).as_deref() {
        None => all(),
        Some("octave") => octave::octave(),
        Some("fmu") => fmu::fmu(),
        Some(other) => Err(format!("no runs of the name {other}: octave, fmu or none").into()),
    }
}
