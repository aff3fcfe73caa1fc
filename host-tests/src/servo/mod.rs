//! The adaptive position loop of the core on simulated axes.
//!
//! | file | what |
//! |---|---|
//! | [`scenario`] | what happens to the drive |
//! | [`plant`] | the drive, and how a scenario changes it |
//! | [`rig`] | the loop of the core on the drive, sample by sample |
//! | [`shadow`] | a second loop in step with that of the rig |
//! | [`figures`] | the figures of a run, and what is wanted of them |
//! | [`population`] | axes drawn at random, with the controller of a practitioner beside the loop |
//! | [`faults`] | faults of sensor, valve and axis, and work without any |
//! | `passage` | a run on its way: samples, requests, steps, sines |
//! | [`mod@run`] | a scenario from the commissioning to its figures |
//! | [`bridging`] | the loop on a sensor that fails now and then |

pub mod bridging;
pub mod faults;
pub mod figures;
mod passage;
pub mod plant;
pub mod population;
pub mod rig;
pub mod run;
pub mod scenario;
pub mod shadow;
