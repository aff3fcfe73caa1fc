//! Bytes for [`trendid_fuzz::store`].
#![cfg_attr(fuzzing, no_main)]

trendid_fuzz::target!(trendid_fuzz::store::run);
