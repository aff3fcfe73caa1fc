//! Does the estimate stay true over hours? Every kind of motion a drive knows, with every memory.
//!
//! A run begins with ten seconds of binary noise; then the scenario lasts as long as asked. Where
//! the data obey the model the estimate is compared with the truth all the time; where they do not
//! (the axis is blocked, the command stays inside the dead zone), ten seconds of motion follow, and
//! the estimate is compared at their end.
//!
//! | file | what |
//! |---|---|
//! | [`motion`] | commands without end |
//! | [`axis`] | plants that are fast to simulate |
//! | [`scenario`] | what is run: scenarios, structures, memories |
//! | `reading` | C, omega0, xi of an estimate |
//! | [`found`] | what came out of a run, and its limits |
//! | `others` | other ways to forget, for comparison |
//! | `runner` | axis, commands and noise around an identifier |
//! | [`run`] | one run |

pub mod axis;
pub mod found;
pub mod motion;
mod others;
mod reading;
pub mod run;
mod runner;
pub mod scenario;
