//! Bytes for [`trendid_fuzz::link`].
#![cfg_attr(fuzzing, no_main)]

trendid_fuzz::target!(trendid_fuzz::link::run);
