//! The adaptive position loop: code of the sensor in, command of the valve out.

mod calls;
mod edge;
mod names;
mod quality;
mod report;
mod settings;

pub use calls::*;
pub(crate) use edge::Body;
pub use quality::*;
pub(crate) use report::reason_code;
pub use report::*;
pub use settings::*;
