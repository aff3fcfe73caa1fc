//! Users of the identifier drawn at random: what they have, what they tell, how they move it.
//!
//! | file | what |
//! |---|---|
//! | [`kind`] | twelve structures |
//! | [`command`] | seven ways to move a drive |
//! | [`mod@draw`] | one user of a seed, and the ranges |
//! | [`mod@record`] | the exact simulation of its drive, what its sensor gives and what is missed |
//! | [`reading`] | errors of a reading in standard deviations and of the truth |
//! | [`identified`] | the identifier of the core on a record |
//! | [`filter`] | the extended Kalman filter on the same record |
//! | [`trial`] | one user with both |
//! | [`figures`] | the figures of many users |

pub mod command;
pub mod draw;
pub mod figures;
pub mod filter;
pub mod identified;
pub mod kind;
pub mod reading;
pub mod record;
pub mod trial;

#[cfg(test)]
mod tests;
