//! `trendid identify` and `trendid select`: models from records.

pub(crate) mod command;
mod figures;
mod report;
mod report_json;
pub(crate) mod select;
pub(crate) mod signals;
