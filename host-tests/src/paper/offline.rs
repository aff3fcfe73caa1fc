//! Fits of the servo that see a whole record at once.

use crate::oracles::cramer_rao::Coefficient;
use crate::oracles::ekf::Prior;
use crate::oracles::least_squares::{Regression, Structure, least_squares};
use crate::oracles::output_error::{OutputErrorFit, output_error};
use crate::oracles::trends::Scheme;
use crate::plants::servo::{REFERENCE, Servo};
use crate::signals::experiment::Record;

/// The output-error fit of a1, a2, b0 and the first position, from the tuned prior on; `None` when
/// the record does not determine them.
pub fn output_error_fit(record: &Record) -> Option<OutputErrorFit> {
    let free = [
        Coefficient::A(1),
        Coefficient::A(2),
        Coefficient::B { input: 0, power: 0 },
        Coefficient::Initial(0),
    ];
    let start = Prior::tuned(1.0).servo.plant(record.dt);
    output_error(&start, &free, &[0.0; 3], &[&record.u], &record.y)
}

/// Errors of C, w0, xi \[%\] of batch least squares on raw trends, or on trends filtered by `f`
/// (ascending, monic).
///
/// # Panics
/// When the record does not excite the servo.
pub fn batch_error_pct(record: &Record, scheme: Scheme, f: Option<&[f64]>) -> [f64; 3] {
    let u = [record.u.as_slice()];
    let rows = Regression::new(&Structure::servo(), scheme, f, record.dt, &u, &record.y);
    let theta = least_squares(&rows.phi, &rows.target, None)
        .expect("excited")
        .theta;
    Servo::from_coefficients(theta[0], theta[1], theta[2])
        .expect("a1 > 0")
        .error_pct(&REFERENCE)
}
