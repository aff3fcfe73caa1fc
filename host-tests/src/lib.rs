//! Simulated drives, oracles and bounds in f64 against which the core is judged.
//!
//! Nothing here uses the core's arithmetic: an oracle that shared code could not disagree.
//!
//! | module | what |
//! |---|---|
//! | [`plant`] | linear plants of order 1 to 4, exact for held inputs |
//! | [`reference`] | the servo of the paper's Table 2 and its physical reading |
//! | [`nonlinear`] | valve defects and Coulomb friction |

pub mod nonlinear;
pub mod plant;
pub mod reference;
