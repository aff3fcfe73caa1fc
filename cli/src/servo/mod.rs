//! The servo: the demonstration, the adaptive position loop, the linear drive.

pub mod demo;
mod demo_loop;
mod figure;
pub mod linear;
pub mod position_loop;
