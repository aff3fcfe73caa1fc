//! What a drive is moved with and what its sensor adds.
//!
//! | file | what |
//! |---|---|
//! | [`noise`] | drift, white noise and resolution in both readings of the paper's widths |
//! | [`mod@shift_register`] | binary sequences of maximum length |
//! | [`excitation`] | binary noise, steps, square, multisine, chirp, fixed controller |
//! | [`experiment`] | plant, excitation, valve and noise put together into a record |

pub mod excitation;
pub mod experiment;
pub mod noise;
pub mod shift_register;
