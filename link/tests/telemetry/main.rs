//! Telemetry over lines that damage, cut, repeat and lose.

mod damage;
#[path = "../common/dice.rs"]
mod dice;
mod ends;
mod line;
mod values;
