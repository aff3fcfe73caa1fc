//! The adaptive position loop of the core on simulated axes.
//!
//! | file | what |
//! |---|---|
//! | [`scenario`] | what happens to the drive, and the figures of a run |
//! | [`shadow`] | a second loop beside the one of a scenario |

pub mod scenario;
pub mod shadow;
