//! Bytes for [`trendid_fuzz::servo_loop`].
#![cfg_attr(fuzzing, no_main)]

trendid_fuzz::target!(trendid_fuzz::servo_loop::run);
