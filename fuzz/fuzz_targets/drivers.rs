//! Bytes for [`trendid_fuzz::drivers`].
#![cfg_attr(fuzzing, no_main)]

trendid_fuzz::target!(trendid_fuzz::drivers::run);
