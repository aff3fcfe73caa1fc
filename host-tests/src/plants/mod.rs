//! Simulated drives.
//!
//! | file | what |
//! |---|---|
//! | [`polynomial`] | polynomials in the back shift, difference equations |
//! | [`exponential`] | matrix exponential, companion matrix, exact discretisation |
//! | [`drawn`] | linear plants drawn by a seed, each with a record |
//! | [`linear`] | linear plants of order 1 to 4, exact for held inputs |
//! | [`mod@servo`] | the servo of the paper's Table 2 and its physical reading |
//! | [`valve`] | a valve with dead zone, offset and unequal gain; Coulomb friction |
//! | [`pneumatic`] | nonlinear pneumatic servo axis: cylinder, valve, friction, sensor |
//! | [`third_order`] | drive of third order with friction that sticks, end stops and a valve |

pub mod drawn;
pub mod exponential;
pub mod linear;
pub mod pneumatic;
pub mod polynomial;
pub mod servo;
pub mod third_order;
pub mod valve;
