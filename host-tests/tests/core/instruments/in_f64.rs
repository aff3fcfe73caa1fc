//! The equations of the instruments in f64.

use nalgebra::{DMatrix, DVector};
use trendid_host_tests::oracles::trends::{self as oracle, applied};
use trendid_host_tests::plants::polynomial::{difference_equation, power, product, scaled, sum};
use trendid_host_tests::signals::experiment::Record;

use crate::common::{SERVO_FILTER, rounded, servo_rows};

/// Rows with the same instruments at 20 rad/s and 1 kHz.
const GROUP: usize = 4;

/// Theta in f64 by the equations of the module, with the auxiliary denominator of the default
/// filter.
pub(crate) fn in_f64(record: &Record) -> [f64; 5] {
    let dt = record.dt;
    let (phi, psi) = servo_rows(record);
    let scheme = oracle::Scheme::Tustin;
    let u = rounded(&record.u);
    // s^j / A_z of u / A_f, s = 2/dt (1-q)/(1+q).
    let first = oracle::input_trend(scheme, oracle::Hold::Zero, 3, 0, dt);
    let once = applied(&first, scheme, Some(&SERVO_FILTER), dt, &u);
    // One set of instruments for each group of rows.
    let held: Vec<f64> = once.iter().copied().step_by(GROUP).collect();
    let step = GROUP as f64 * dt;
    let term = |j: usize| {
        let both = product(&power(&[1.0, -1.0], j), &power(&[1.0, 1.0], 2 - j));
        scaled(&both, (2.0 / step).powi(j as i32))
    };
    let denominator = sum(
        &sum(&scaled(&term(0), 484.0), &scaled(&term(1), 30.8)),
        &term(2),
    );
    let twice: Vec<Vec<f64>> = (0..2)
        .map(|j| difference_equation(&term(j), &denominator, &held))
        .collect();
    let n = psi.len();
    let solved = |z: &DMatrix<f64>| -> DVector<f64> {
        let scale = DVector::from_fn(5, |j, _| phi.column(j).norm());
        let rows = DVector::from_fn(5, |i, _| z.column(i).norm());
        let (m, r) = (z.transpose() * &phi, z.transpose() * &psi);
        let m = DMatrix::from_fn(5, 5, |i, j| m[(i, j)] / (rows[i] * scale[j]));
        let r = r.component_div(&rows);
        m.full_piv_lu().solve(&r).unwrap().component_div(&scale)
    };
    let mut theta = solved(&phi);
    for _ in 0..6 {
        // The trends of the first sample give no row.
        let mut z = DMatrix::from_fn(n, 5, |k, j| phi[((k - k % GROUP).max(1), j)]);
        for i in 0..2 {
            z.set_column(
                i,
                &DVector::from_fn(n, |k, _| -theta[2] * twice[i][k / GROUP]),
            );
        }
        theta = solved(&z);
    }
    core::array::from_fn(|j| theta[j])
}
