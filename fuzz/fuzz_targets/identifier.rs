//! Bytes for [`trendid_fuzz::identifier`].
#![cfg_attr(fuzzing, no_main)]

trendid_fuzz::target!(trendid_fuzz::identifier::run);
