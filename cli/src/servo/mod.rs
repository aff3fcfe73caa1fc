//! The servo: the demonstration, the adaptive position loop, the linear drive.

pub mod demo;
mod demo_loop;
mod figure;
mod linear;
pub mod linear_args;
mod linear_report;
mod population;
mod population_rows;
pub mod position_loop;
