//! The servo: the demonstration, the adaptive position loop, the linear drive.

pub(crate) mod demo;
mod demo_axis;
mod demo_loop;
mod figure;
mod linear;
pub(crate) mod linear_args;
mod linear_report;
mod population;
mod population_faults;
mod population_rows;
mod population_work;
pub(crate) mod position_loop;
