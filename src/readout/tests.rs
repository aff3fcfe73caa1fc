//! Readings of recursions that are put together here: covariances of each part alone.

mod nominal;
mod slope;
mod white;

use super::*;
use crate::estimation::beginning::Beginning;
use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::regressor::Regressor;
use crate::estimation::rls::Estimator;
use crate::estimation::start_error::StartError;
use crate::estimation::structure::Structure;
use crate::readout::floor::{ARITHMETIC, DISCRETE};
use crate::trends::{Design, FilteredTrends, RawTrends, Scheme, TrendOperator};

const BANDWIDTH: f32 = 20.0;
/// a1, a2, b0 and a constant of a servo.
type Servo = Structure<3, 4, 1>;
const SERVO: Servo = Structure::INTEGRATING_WITH_CONSTANT;
/// Parameters in their units: 400, 20, 1e6 and an offset.
const THETA: [f32; 4] = [400.0, 20.0, 1e6, 3e4];
/// Variance of the residual of psi.
const NOISE: f32 = 4e-6;

/// Everything that a reading borrows.
struct Parts {
    design: Design<3>,
    regressor: Regressor<3, 4>,
    estimator: Estimator<4>,
    forgetting: StabilisedForgetting<4>,
    noise: NoiseLevel,
    position: f32,
    significance: f32,
    prior_noise: f32,
    former: Former,
    beginning: Beginning<4>,
    start_error: StartError<3, 4>,
}

impl Parts {
    /// A recursion after so many rows by chance about the parameters of the servo; `std` is that of
    /// the prior.
    fn new(design: Design<3>, std: [f32; 4], lambda: f32, rows: u32) -> Self {
        let regressor = Regressor::new(&SERVO, &design, BANDWIDTH, &[0.4], 50.0);
        let theta = core::array::from_fn(|j| THETA[j] / regressor.units()[j]);
        let mut estimator = Estimator::new(theta, std, lambda);
        let mut state = 1_u32;
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 8_388_608.0 - 1.0
        };
        for k in 0..rows {
            let phi: [f32; 4] = core::array::from_fn(|_| draw());
            let psi: f32 = phi.iter().zip(theta).map(|(a, b)| a * b).sum();
            let error = if k % 2 == 0 { 2e-3 } else { -2e-3 };
            let _ = estimator.update(&phi, psi + error);
        }
        estimator.finish_observation();
        let start_error = StartError::new(&design, 0);
        Self {
            design,
            regressor,
            estimator,
            forgetting: StabilisedForgetting::new(theta, lambda),
            noise: NoiseLevel::new(lambda),
            position: 0.0,
            significance: 0.0,
            prior_noise: 1e-2,
            former: Former::NONE,
            beginning: Beginning::new(true),
            start_error,
        }
    }

    fn read(&self) -> ReadOut<'_, 3, 4, 1> {
        self.read_as(&SERVO)
    }

    /// The same recursion taken for one of another structure.
    fn read_as<'a, const I: usize>(
        &'a self,
        structure: &'a Structure<3, 4, I>,
    ) -> ReadOut<'a, 3, 4, I> {
        ReadOut {
            structure,
            design: &self.design,
            regressor: &self.regressor,
            bandwidth: BANDWIDTH,
            prior_noise: self.prior_noise,
            significance: self.significance,
            estimator: &self.estimator,
            forgetting: &self.forgetting,
            turns: false,
            delay_parts: const { &[0.0; I] },
            former: self.former,
            position: self.position,
            noise: &self.noise,
            beginning: &self.beginning,
            start_error: &self.start_error,
        }
    }
}

fn raw() -> Design<3> {
    let trends = RawTrends::<3>::try_new(Scheme::Tustin, 1e-3).expect("a sample time");
    trends.design().clone()
}

fn filtered() -> Design<3> {
    let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 1e-3, BANDWIDTH);
    trends.expect("a filter").design().clone()
}

fn close(found: f32, exact: f32, share: f32) -> bool {
    (found - exact).abs() <= share * exact.abs()
}

#[test]
fn without_a_filter_the_covariance_is_that_of_least_squares_and_of_the_trends() {
    let parts = Parts::new(raw(), [1e2; 4], 1.0, 400);
    let read = parts.read();
    let (found, bare) = (read.estimate(), read.recursion());
    assert_eq!(found.theta, bare.theta);
    for i in 0..4 {
        for j in 0..4 {
            let own = if i == j { 1.01 } else { 1.0 };
            // 20 rad/s at 1 ms.
            let floor = ARITHMETIC + DISCRETE * 0.02 * 0.02;
            let floor = own * floor * floor * found.theta[i] * found.theta[j];
            let exact = bare.covariance[i][j] + floor;
            let size = (bare.covariance[i][i] * bare.covariance[j][j]).sqrt();
            let error = (found.covariance[i][j] - exact).abs();
            assert!(
                error < 2e-3 * (size + floor.abs()),
                "{i} {j}: {error} of {size}"
            );
        }
        let units = parts.regressor.units();
        let p = parts.estimator.covariance(i, i);
        assert!(close(
            bare.covariance[i][i],
            NOISE * 400.0 / 396.0 * p * units[i] * units[i],
            0.1
        ));
    }
}

#[test]
fn the_error_of_trends_is_common_to_all_coefficients_and_no_known_one_has_it() {
    let mut parts = Parts::new(filtered(), [1e2, 0.0, 1e2, 1e2], 1.0, 400);
    // A residual of nothing: the floor alone is left.
    parts.prior_noise = 0.0;
    parts.estimator = Estimator::new(*parts.estimator.theta(), [1e-9, 0.0, 1e-9, 1e-9], 1.0);
    let found = parts.read().estimate();
    let angle = 20.0 * 1e-3;
    let share = parts
        .design
        .discretisation_share(&[0.0, 400.0, 20.0], false);
    let floor = ARITHMETIC + DISCRETE * angle * angle * share;
    let [a1, a2, b0, constant] = [0, 1, 2, 3].map(|i| found.covariance[i]);
    assert!(
        close(a1[0], 1.01 * floor * floor * 400.0 * 400.0, 1e-3),
        "{a1:?}"
    );
    assert!(close(b0[2], 1.01 * floor * floor * 1e12, 1e-3), "{b0:?}");
    assert!(close(a1[2], floor * floor * 400.0 * 1e6, 1e-3) && a1[2] == b0[0]);
    // A constant errs as the numerator with which it stands.
    let [_, _, _, offset] = found.theta;
    assert!(close(constant[2], floor * floor * offset * 1e6, 1e-3));
    for j in 0..4 {
        assert_eq!((a2[j], found.covariance[j][1]), (0.0, 0.0));
    }
    // By scores the same.
    let scores = parts
        .read()
        .under(|_, _| Some([[0.0; 4]; 4]))
        .expect("an estimate");
    for i in 0..4 {
        for j in 0..4 {
            let error = (scores.covariance[i][j] - found.covariance[i][j]).abs();
            assert!(
                error <= 1e-5 * floor * floor * THETA[i].abs() * THETA[j].abs(),
                "{i} {j}"
            );
        }
    }
    let zero = parts
        .read()
        .with_covariance(parts.estimator.theta(), &[[0.0; 4]; 4], None, 0.0);
    // Scores that vary by nothing saw nothing, but of what is known.
    for i in 0..4 {
        let alone = if i == 1 { 0.0 } else { f32::INFINITY };
        assert_eq!(zero.covariance[i][i], alone, "{i}");
    }
}

#[test]
fn a_position_far_away_is_rounded_and_that_is_no_white_noise() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 1.0, 400);
    let square = |position: f32, parts: &Parts| {
        let step = parts.regressor.top_scale() * 0.25 * f32::EPSILON * position;
        step * step
    };
    for position in [1e3, -1e6_f32] {
        parts.position = position;
        let read = parts.read();
        let all = square(position, &parts);
        // As far as the noise does not hide it.
        assert!(close(read.resolution(0.5 * all), all, 1e-4));
        assert!(close(read.resolution(10.0 * all), 0.1 * all, 1e-4));
    }
    // 2/(omega Delta) samples count as one.
    parts.position = 0.0;
    let near = parts.read().estimate();
    parts.position = 3e6;
    let far = parts.read().estimate();
    let more = square(3e6, &parts) * 2.0 / 0.02;
    for i in 0..4 {
        let unit = parts.regressor.units()[i];
        let added = far.covariance[i][i] - near.covariance[i][i];
        let exact = more * parts.estimator.covariance(i, i) * unit * unit;
        assert!(close(added, exact, 0.02), "{i}: {added} {exact}");
    }
}

#[test]
fn of_what_a_drive_has_just_become_nothing_is_known() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 0.999, 400);
    assert!(
        parts
            .read()
            .estimate()
            .std()
            .iter()
            .all(|std| std.is_finite())
    );
    parts.former = Former::behind(true, 0.0, 1e-3);
    let found = parts.read().estimate();
    for i in 0..4 {
        assert_eq!(found.covariance[i][i], f32::INFINITY, "{i}");
    }
    // As little without a residual and a parameter to err by.
    let mut parts = Parts::new(raw(), [1e2; 4], 1.0, 0);
    parts.prior_noise = 0.0;
    parts.estimator = Estimator::new([1.0, 1.0, 1.0, 0.0], [1e2; 4], 1.0);
    let found = parts.read().estimate();
    assert_eq!(found.covariance[3][3], f32::INFINITY);
}

#[test]
fn what_is_left_of_another_drive_is_added_to_what_may_have_changed() {
    for known in [[false; 4], [false, true, false, false]] {
        let std = known.map(|known| if known { 0.0 } else { 1e2 });
        let mut parts = Parts::new(filtered(), std, 0.999, 400);
        let none = parts.read().estimate().covariance;
        parts.former = Former::behind(false, 50.0, 0.01);
        let found = parts.read().estimate().covariance;
        // Neither the constant nor what is known is a coefficient of another drive.
        let coefficients = [true, !known[1], true, false];
        let (p, units) = (parts.estimator.covariances(), parts.regressor.units());
        let left = || parts.forgetting.left();
        let mut exact = [[0.0; 4]; 4];
        (parts.former).add(coefficients, left, 20.0 * 1e-3, &p, &mut exact);
        for i in 0..4 {
            let added = (found[i][i] - none[i][i]) / (units[i] * units[i]);
            assert!(close(added, exact[i][i], 1e-2), "{known:?} {i}: {added}");
        }
    }
}

#[test]
fn an_initial_state_is_none_of_what_trends_bend() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 1.0, 400);
    parts.prior_noise = 0.0;
    // The floor alone is left.
    parts.estimator = Estimator::new(*parts.estimator.theta(), [1e-9; 4], 1.0);
    let initial = Servo::INTEGRATING_WITH_INITIAL_STATE;
    let found = parts.read_as(&initial).estimate();
    let share = |i: usize| libm::sqrtf(found.covariance[i][i]) / found.theta[i].abs();
    assert!(
        found.theta[3] != 0.0 && share(3) < 1e-2 * share(2),
        "{}",
        share(3)
    );
}
