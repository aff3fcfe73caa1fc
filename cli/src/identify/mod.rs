//! `trendid identify` and `trendid select`: models from records.

pub(crate) mod command;
mod figures;
mod report;
pub(crate) mod select;
pub(crate) mod signals;
