//! Bytes for [`trendid_fuzz::record`].
#![cfg_attr(fuzzing, no_main)]

trendid_fuzz::target!(trendid_fuzz::record::run);
