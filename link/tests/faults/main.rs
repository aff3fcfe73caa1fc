//! The lockstep over a line that corrupts, drops and repeats bytes and frames.

#[path = "../common/dice.rs"]
mod dice;
mod ends;
mod layout;
mod lockstep;
