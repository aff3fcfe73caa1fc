//! The paper's Table 1, reproduced with the core and its opponents.
//!
//! | file | what |
//! |---|---|
//! | [`mod@table1`] | the conditions and printed figures of the table |
//! | [`methods`] | conditions, filters and methods of the reproduction |
//! | [`transient`] | how an estimate comes to its end through a record |
//! | [`offline`] | fits that see a whole record at once |
//! | [`options`] | one record without and with each option of the core |
//! | [`mod@trial`] | one record through every method |
//! | [`statistics`] | statistics over many records |
//! | [`mod@drives`] | servo drives, and what is told of them, drawn at random |
//! | [`mod@sigma`] | standard deviations side by side |
//! | [`mod@coverage`] | how often the true value lies within the reported standard deviations |
//! | [`iterations`] | exact trends with the model of the iteration before |

pub mod coverage;
pub mod drives;
pub mod iterations;
pub mod methods;
pub mod offline;
pub mod options;
pub mod sigma;
pub mod statistics;
pub mod table1;
pub mod transient;
pub mod trial;
