//! Settings of identifiers and loops: what is taken, what is refused, and under which name.

#![cfg(feature = "any")]

mod axis;
mod core_config;
mod kinds;
mod meaning;
mod sweep;
mod words;
