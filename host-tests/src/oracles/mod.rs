//! Other ways to the same numbers, in f64 and without the core.
//!
//! | file | what |
//! |---|---|
//! | [`trends`] | trends, raw and filtered in two ways |
//! | [`least_squares`] | least squares by singular values, batch equivalent of a recursion, (9)-(11) |
//! | [`ekf`] | extended Kalman filter on the joint state |
//! | [`mod@cramer_rao`] | Cramer-Rao bound of coefficients and of C, w0, xi |
//! | [`forgetting`] | plain, directional and stabilised forgetting |
//! | [`mod@output_error`] | offline fit of the free simulation |

pub mod cramer_rao;
pub mod ekf;
pub mod forgetting;
pub mod least_squares;
pub mod output_error;
pub mod trends;
