//! A beginning whose first sample is wrong, and nothing else.

use crate::Structure;
use crate::identifier::{Config, Identifier};
use crate::readout::beginning::{Column, Regression};
use crate::trends::{FilteredTrends, Scheme};

const ERROR: f32 = 0.05;

type Motor = Identifier<FilteredTrends<2>, 2, 2>;

/// dv/dt = -10 v + 50 u, dy/dt = v under steps of u, y(0) off by `error`.
fn motor(error: f32) -> Motor {
    let mut config = Config::new(Structure::INTEGRATING, 10.0, [1.0], 1.0);
    // No line through the first samples, and no row before the pole 11 has settled.
    (config.supervised, config.settling) = (true, 0.4);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 10.0);
    let mut found = Motor::try_new(&config, trends.expect("a filter")).expect("settings");
    let (mut y, mut v) = (0.0_f32, 0.0_f32);
    for k in 0..1500 {
        let u = if (k / 100) % 2 == 0 { 1.0 } else { -1.0 };
        let _ = found.update(u, if k == 0 { error } else { y });
        let (decay, target) = ((-0.01_f32).exp(), 5.0 * u);
        y += 1e-3 * target + (v - target) * (1.0 - decay) * 0.1;
        v = target + (v - target) * decay;
    }
    found
}

/// What its beginning has done: gamma.
fn begun(of: &Motor) -> f32 {
    let read = of.read_out();
    let found = read.column(&read.recursion_alone());
    found.expect("a beginning").gamma
}

#[test]
fn an_error_of_the_first_sample_is_found_by_its_residue_and_taken_out() {
    let (wrong, right) = (motor(ERROR), motor(0.0));
    // Poles 1.1 and 11: A(-1.1) = 1.21 - 11, A_f'(-1.1) = 11 - 1.1, and 1.1 of nu.
    let kappa = (1.21 - 11.0) / (1.1 * 9.9);
    let found = begun(&wrong) - begun(&right);
    let exact = kappa * ERROR * wrong.read_out().regressor.top_scale();
    // What is known beforehand keeps a part of it.
    let kept = (0.7..1.0).contains(&(found / exact));
    assert!(kept, "{found} {exact}");
    let bare = wrong.recursion().theta();
    let errors = [wrong.theta(), bare].map(|theta| (theta[0] / 10.0 - 1.0).abs());
    assert!(errors[0] < 0.3 * errors[1], "{errors:?}");
}

/// The column where a P says that all of the sums is that of the first parameter.
fn of_parameters<const M: usize, const N: usize>(
    of: &Identifier<FilteredTrends<M>, M, N>,
    theta: [f32; N],
) -> Column<N> {
    let read = of.read_out();
    let (sums, mut p) = (read.beginning, [[0.0; N]; N]);
    p[0][0] = 2.0 * sums.square / (sums.moments[0] * sums.moments[0]);
    let found = read.column(&Regression { theta, p });
    found.expect("a beginning")
}

#[test]
fn a_beginning_that_no_row_has_seen_stays_as_uncertain_as_noise_leaves_it() {
    let motor = motor(ERROR);
    let found = of_parameters(&motor, *motor.estimator().theta());
    assert_eq!(found.gamma, 0.0);
    let [a1, _] = motor.recursion().theta();
    let kappa = (1.21 - 1.1 * a1) / (1.1 * 9.9);
    assert!((found.variance / (kappa * kappa) - 1.0).abs() < 1e-2);
}

#[test]
fn behind_a_pair_of_poles_the_residue_is_that_of_the_slow_one() {
    let structure = Structure::<3, 3, 1>::INTEGRATING;
    let config = Config::new(structure, 20.0, [1.0], 1.0);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let mut servo =
        Identifier::<FilteredTrends<3>, 3, 3>::try_new(&config, trends).expect("settings");
    for k in 0..200 {
        let _ = servo.update(1.0, 1e-6 * (k * k) as f32);
    }
    let found = of_parameters(&servo, [0.0; 3]);
    // Poles 2.2 and those of s^2 + 30.8 s + 484; A = s^3, whose a_1 is as uncertain as P says.
    let steep = 2.2 * (2.2 * 2.2 - 30.8 * 2.2 + 484.0);
    let (sums, scale) = (servo.state.beginning, servo.plan.regressor.units()[0]);
    let p = 2.0 * sums.square / (sums.moments[0] * sums.moments[0]);
    let of_a1 = (2.2 * scale) * (2.2 * scale) * p * servo.read_out().residual();
    let square = (2.2_f32.powi(6) + of_a1) / (steep * steep);
    assert!((found.variance / square - 1.0).abs() < 1e-2, "{found:?}");
    assert!(of_a1 > 0.1 * 2.2_f32.powi(6));
}
