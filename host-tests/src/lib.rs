//! Simulated drives, oracles and bounds in f64 against which the core is judged.
//!
//! Nothing here uses the core's arithmetic: an oracle that shared code could not disagree.
//!
//! | module | what |
//! |---|---|
//! | [`plant`] | linear plants of order 1 to 4, exact for held inputs |
//! | [`mod@reference`] | the servo of the paper's Table 2 and its physical reading |
//! | [`nonlinear`] | valve defects and Coulomb friction |
//! | [`pneumatic`] | nonlinear pneumatic servo axis: cylinder, valve, friction, sensor |
//! | [`noise`] | drift, white noise and resolution in both readings of the paper's widths |
//! | [`excitation`] | binary noise, steps, square, multisine, chirp, fixed controller |
//! | [`experiment`] | plant, excitation, valve and noise put together into a record |
//! | [`polynomial`] | polynomials in the back shift, difference equations |
//! | [`trends`] | trends in f64, raw and filtered in two ways |
//! | [`oracle`] | least squares by singular values, batch equivalent of a recursion, (9)-(11) |
//! | [`exponential`] | matrix exponential, exact discretisation |
//! | [`bound`] | Cramer-Rao bound of coefficients and of C, w0, xi |
//! | [`output_error`] | offline fit of the free simulation, for comparison |
//! | [`ekf`] | extended Kalman filter on the joint state, for comparison |
//! | [`companion`] | a second loop beside the one of a scenario |
//! | [`scenario`] | the adaptive position loop of the core on simulated axes |
//! | [`table1`] | the conditions and printed figures of the paper's Table 1 |
//! | [`methods`] | conditions, filters and methods of the reproduced Table 1 |
//! | [`montecarlo`] | one record through every method |
//! | [`rounds`] | exact trends with the model of the round before, settling of a new filter |
//! | [`table_run`] | statistics over many records |

pub mod bound;
pub mod companion;
pub mod ekf;
pub mod excitation;
pub mod experiment;
pub mod exponential;
pub mod methods;
pub mod montecarlo;
pub mod noise;
pub mod nonlinear;
pub mod oracle;
pub mod output_error;
pub mod plant;
pub mod pneumatic;
pub mod polynomial;
pub mod reference;
pub mod rounds;
pub mod scenario;
pub mod table1;
pub mod table_run;
pub mod trends;
