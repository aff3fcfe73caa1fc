//! Signs, scales and noise, by the samples themselves.

use super::*;
use crate::estimation::terms::Terms;
use crate::trends::{FilteredTrends, Form, Memory, Scheme, TrendOperator};

/// y'' = -a1 y' - a0 y + b0 u + d, behind a filter of 20 rad/s at 1 kHz, with an initial state.
fn parts() -> (FilteredTrends<2>, Regressor<2, 5>) {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let inputs = [Terms::of(&[0])];
    let structure = Structure::try_with_initial_state(Terms::up_to(2), inputs, true);
    let structure = structure.expect("a structure");
    let regressor = Regressor::new(&structure, trends.design(), 20.0, &[0.5], 40.0);
    (trends, regressor)
}

fn near(found: f32, exact: f32) {
    let size = exact.abs().max(1e-30);
    assert!((found - exact).abs() < 1e-3 * size, "{found} for {exact}");
}

#[test]
fn every_entry_has_its_trend_its_sign_and_its_scale() {
    let (_, regressor) = parts();
    let output = Trends {
        lower: [3.0, 5.0],
        top: 7.0,
    };
    let (phi, psi) = regressor.assemble(&output, &[[11.0, 13.0]], &[17.0, 19.0]);
    // Of size 1 is a signal of 40 or 0.5 at 20 rad/s: y'' of 40, y' of 40/20, y of 40/400.
    near(psi, 7.0 / 40.0);
    near(phi[0], -3.0 / (40.0 / 400.0));
    near(phi[1], -5.0 / (40.0 / 20.0));
    near(phi[2], 11.0 / (0.5 / 400.0));
    near(phi[3], 17.0 / (1.0 / 400.0));
    for (entry, trend) in phi.iter().zip([-3.0, -5.0, 11.0, 17.0, 19.0]) {
        assert!(entry / trend > 0.0);
    }
    near(regressor.top_scale(), 1.0 / 40.0);
    // psi = phi' theta in any units: entry by entry, the scale of the row over that of psi.
    for (j, trend) in [-3.0, -5.0, 11.0, 17.0, 19.0].into_iter().enumerate() {
        near(phi[j] / trend, regressor.units()[j] * regressor.top_scale());
    }
}

#[test]
fn the_weight_of_y_is_what_a_unit_of_y_adds_to_the_error() {
    let (trends, regressor) = parts();
    let design = trends.design();
    let memory = Memory::output_at_rest(design, Form::Position, 0.0);
    let mut other = memory;
    let unit = trends.output(&mut other, 1.0, Form::Position);
    let (phi, psi) = regressor.assemble(&unit, &[[0.0; 2]], &[0.0; 2]);
    for theta in [
        [0.0; 5],
        [0.3, -40.0, 9.0, 9.0, 9.0],
        [30.0, 20.0, 0.0, 0.0, 0.0],
    ] {
        let error = psi - phi[0] * theta[0] - phi[1] * theta[1];
        near(regressor.feedthrough(&theta), error);
    }
    // What would make it small or negative is no model: a tenth of what it is without.
    let huge = [0.0, 1e6, 0.0, 0.0, 0.0].map(|x: f32| -x);
    near(regressor.feedthrough(&huge), 0.1 * psi);
    near(regressor.noise(3.0), 3.0 * psi);
}

/// Sums of phi phi', phi psi and psi psi behind one sample of `first`, and `later` ones.
fn squares(first: f32, later: f32) -> ([[f32; 5]; 5], [f32; 5], f32) {
    let (trends, regressor) = parts();
    let mut memory = Memory::output_at_rest(trends.design(), Form::Position, 0.0);
    let (mut matrix, mut vector, mut square) = ([[0.0_f32; 5]; 5], [0.0_f32; 5], 0.0_f32);
    for k in 0..10_000 {
        let y = if k == 0 { first } else { later };
        let output = trends.output(&mut memory, y, Form::Position);
        let (phi, psi) = regressor.assemble(&output, &[[0.0; 2]], &[0.0; 2]);
        for i in 0..5 {
            for j in 0..5 {
                matrix[i][j] += phi[i] * phi[j];
            }
            vector[i] += phi[i] * psi;
        }
        square += psi * psi;
    }
    (matrix, vector, square)
}

#[test]
fn moments_of_noise_are_the_sums_of_squares_behind_one_sample() {
    let (trends, regressor) = parts();
    let (matrix, vector, square) = squares(1.0, 0.0);
    let (moments, mixed, top) = regressor.noise_moments::<0>(&trends.design().noise_gain);
    near(top, square);
    for i in 0..2 {
        let size = libm::sqrtf(matrix[i][i] * square);
        assert!((mixed[i] - vector[i]).abs() <= 1e-3 * size, "{i}");
        for j in 0..2 {
            let size = libm::sqrtf(matrix[i][i] * matrix[j][j]);
            let error = (moments[i][j] - matrix[i][j]).abs();
            assert!(error <= 1e-3 * size, "{i} {j}: {error} of {size}");
        }
    }
}

#[test]
fn noise_that_is_summed_up_makes_the_trends_one_order_lower() {
    let (trends, regressor) = parts();
    // The sum of one sample, over time.
    let (matrix, vector, square) = squares(0.5e-3, 1e-3);
    let (moments, mixed, top) = regressor.noise_moments::<1>(&trends.design().noise_gain);
    near(top, square);
    near(moments[1][1], matrix[1][1]);
    let size = libm::sqrtf(matrix[1][1] * square);
    assert!((mixed[1] - vector[1]).abs() <= 1e-3 * size);
    // The parameter of y itself, whose noise would be without a bound.
    assert_eq!((moments[0], moments[1][0], mixed[0]), ([0.0; 2], 0.0, 0.0));
}
