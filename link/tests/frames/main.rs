//! Lockstep and telemetry over lines that damage, drop and repeat.

mod dice;
mod faults;
mod telemetry;
