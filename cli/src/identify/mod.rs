//! `trendid identify` and `trendid select`: models from records.

pub mod command;
mod figures;
mod report;
pub mod select;
pub mod signals;
