//! The lockstep over a line that corrupts, drops and repeats bytes and frames.

mod ends;
mod layout;
mod lockstep;
mod receiver;
