//! Faults of sensor, valve and axis while the loop works, on axes of the population; and normal
//! work, in which no fault is.
//!
//! | file | what |
//! |---|---|
//! | [`fault`] | the faults, and the reasons that are right for them |
//! | [`machine`] | an axis of the population under a loop, with a fault between them |
//! | [`trial`] | one fault in one state of the loop |
//! | [`normal`] | work without a fault, in which an alarm is a false one |
//! | [`summary`] | figures of many |

pub mod fault;
pub mod machine;
pub mod normal;
pub mod summary;
pub mod trial;
