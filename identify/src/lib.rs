//! Identification of recorded drives on the host: slices and options in, values out.
//!
//! The `no_std` core runs sample by sample over a record, with any structure that is chosen
//! at run time. Around it stands what a record allows and a drive does not: the search of
//! filter and delay, held-out halves, free simulation and the choice of the structure.
//! Nothing here reads files, prints or draws.
//!
//! | module | what it does |
//! |---|---|
//! | [`dynamic`] | the core behind sizes that are known only at run time |
//! | [`estimate`] | a model with its covariance, as values |
//! | [`derived`] | gains, time constants and a force balance of a model, with their sigmas |
//! | [`tuning`] | filter and delay, what a run is free to choose |
//! | [`signals`] | inputs and output, checked |
//! | [`problem`] | a structure over signals that can carry it |
//! | [`run`] | passes of the core over the signals |
//! | [`dead_zone`] | the width of a dead zone, by trying |
//! | [`free_run`] | simulation on the inputs alone, the judge of a model |
//! | [`instruments`] | instrumental variables over a whole record, standard deviations by batch means |
//! | [`folds`] | a model judged by what it has not seen |
//! | [`filter_choice`] | the filter by that judge |
//! | [`polynomials`] | a model as its polynomials |
//! | [`delay_choice`] | the delay by that judge |
//! | [`search`] | what a search may choose |
//! | [`poor_input`] | inputs that do not tell a delay |
//! | [`identification`] | one structure: search, estimate, held-out fit |
//! | [`structure_choice`] | many structures compared |
//! | [`mod@side_by_side`] | work on all processors |
//! | [`mod@tune`] | gains of a cascade, a PID controller and a state feedback for a model, with their margins |
//! | [`mod@standstill`] | where friction holds a drive |
//! | [`coulomb_input`] | sgn(v) from a velocity or a position |
//! | [`held_friction`] | sgn(v), and rest, as a model makes them |
//!
//! ```
//! use trendid_identify::{Freedom, Options, Problem, Signals, Structure, identify};
//!
//! // y' = -2 y + 6 u, steps of u held over 10 ms: y(k+1) = e^(-0.02) y(k) + 3 (1 - e^(-0.02)) u(k).
//! let decay = (-0.02_f64).exp();
//! let u: Vec<f64> = (0..2000).map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.5 }).collect();
//! let mut y = vec![0.0];
//! for k in 0..1999 {
//!     y.push(decay * y[k] + 3.0 * (1.0 - decay) * u[k]);
//! }
//! let signals = Signals::held(0.01, &u, &y);
//! let structure = Structure { order: 1, integrator: false, zeros: 0, constant: false };
//! let problem = Problem::new(&signals, structure, Options::default())?;
//! let found = identify(&problem, Freedom::default(), 0, &())?;
//! assert!((found.estimate.a[0] - 2.0).abs() < 1e-3);
//! assert!((found.estimate.b[0][0] - 6.0).abs() < 3e-3);
//! # Ok::<(), trendid_identify::Error>(())
//! ```

mod chance;
pub mod coulomb_input;
pub mod dead_zone;
pub mod delay_choice;
pub mod derived;
pub mod dynamic;
pub mod error;
pub mod estimate;
pub mod filter_choice;
pub mod folds;
pub mod free_run;
pub mod held_friction;
pub mod identification;
mod imitated_delay;
pub mod instruments;
pub mod polynomials;
pub mod poor_input;
pub mod problem;
pub mod run;
mod sampled;
pub mod search;
mod separable;
pub mod side_by_side;
pub mod signals;
pub mod standstill;
pub mod structure_choice;
mod theta;
pub mod tune;
pub mod tuning;

pub use error::{Error, Weakness};
pub use estimate::{Estimate, Reading};
pub use free_run::FreeRun;
pub use identification::{Friction, Identification, Way, identify};
pub use problem::{Options, Problem, Structure};
pub use run::{PredictionErrors, Run, Trace};
pub use search::{Choice, Freedom, Progress};
pub use side_by_side::side_by_side;
pub use signals::{Input, Signals};
pub use structure_choice::{Selection, select};
pub use trendid::trends::{Hold, Scheme};
pub use tuning::Tuning;
