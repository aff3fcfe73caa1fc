//! Simulated drives, oracles and bounds in f64 against which the core is judged.
//!
//! Nothing here uses the core's arithmetic: an oracle that shared code could not disagree. Only
//! [`paper`], [`servo`], [`endurance`] and [`users`] know the core, because they run it.
//!
//! | room | what |
//! |---|---|
//! | [`random`] | random numbers of a seed |
//! | [`plants`] | simulated drives: linear of order 1 to 4, the paper's servo, a valve with defects, a pneumatic axis |
//! | [`signals`] | excitation, noise, and the record of an experiment |
//! | [`oracles`] | other ways to the same numbers: batch least squares, Kalman filter, output error, Cramer-Rao bound |
//! | [`paper`] | the paper's Table 1: its conditions, one record through every method, statistics over many |
//! | [`servo`] | the adaptive position loop of the core on simulated axes |
//! | [`endurance`] | recursions over hours |
//! | [`users`] | users of the identifier drawn at random |
//! | [`settings`] | names of settings |
//!
//! A room uses only the rooms above it.

pub mod endurance;
pub mod oracles;
pub mod paper;
pub mod plants;
pub mod random;
pub mod servo;
pub mod settings;
pub mod signals;
pub mod users;
