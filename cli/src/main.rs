//! Command line of trendid.
#![allow(missing_docs)] // a program: its documentation is `--help`

mod format;
mod freerun;
mod plot;
mod record;

fn main() {}
