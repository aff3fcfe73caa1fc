//! `trendid identify` and `trendid select`: models from records.

pub(crate) mod command;
mod delay_text;
mod figures;
pub(crate) mod names;
mod notes;
pub(crate) mod parse;
pub(crate) mod report;
mod report_json;
pub(crate) mod select;
mod select_report;
pub(crate) mod signals;
mod simulated;
pub(crate) mod structure;
mod verdict;
