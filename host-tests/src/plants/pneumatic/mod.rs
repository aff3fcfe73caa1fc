//! Nonlinear pneumatic servo axis: a plant worth controlling.
//!
//! A double-acting cylinder moves a mass; a 5/3 proportional valve feeds and vents its two
//! chambers. Compressible air, sonic and subsonic flow, spool lag and dead zone, Stribeck friction
//! that sticks, end stops, leakage, and a position sensor with noise and resolution. Everything is
//! f64 and seeded. `docs/pneumatic-axis.md` has the equations and the source of every parameter.
//!
//! | file | what |
//! |---|---|
//! | `parameters` | sizes of a real axis, with checks |
//! | `flow` | ISO 6358 mass flow |
//! | `friction` | Stribeck friction and the decision to stick |
//! | `dynamics` | the differential equations and the fixed-step integrator with events |
//! | `axis` | one call per sample, sensor, changes at run time, faults |
//! | `linear` | C, omega0, xi over the position, for checking an identification |
//!
//! ```
//! use trendid_host_tests::plants::pneumatic::{PneumaticAxis, AxisParameters};
//!
//! let mut axis = PneumaticAxis::new(&AxisParameters::SERVO, 1);
//! let start = axis.measure();
//! for _ in 0..100 {
//!     axis.step(0.2);
//! }
//! assert!(axis.measure() > start + 10.0); // mm, after 100 ms
//! ```

mod axis;
mod dynamics;
mod flow;
mod friction;
mod linear;
mod parameters;

pub use axis::{Fault, PneumaticAxis};
pub use flow::mass_flow;
pub use friction::Friction;
pub use linear::Linearised;
pub use parameters::AxisParameters;
