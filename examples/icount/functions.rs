//! What is counted: one function per row.

use trendid::Outcome;
use trendid::estimation::{Estimator, StabilisedForgetting};
use trendid::instruments::Reading;
use trendid::model::Physical;
use trendid::servo::Report;
use trendid::trends::FilteredTrends;
use trendid_example_support::rows;

use crate::position_loop::{Servo, Still};

/// One function per row: found in the image by its name.
macro_rules! functions {
    ($($name:ident($type:ty, $input:ty) -> $result:ty, |$state:ident, $u:ident, $y:ident| $body:expr;)*) => {$(
        #[inline(never)]
        // SAFETY: the name is used once in this image.
        #[unsafe(no_mangle)]
        pub(crate) fn $name($state: &mut $type, $u: $input, $y: f32) -> $result {
            $body
        }
    )*};
}

functions! {
    row_nothing((), f32) -> f32, |_state, u, _y| u;
    row_raw(rows::Raw, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_filtered(rows::Filtered, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_integral(rows::Integral, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_servo(Servo<Still>, (i32, Option<f32>)) -> Report, |state, u, _y| {
        state.sensor_mut().code = u.0;
        if let Some(target) = u.1 {
            let _ = state.move_to(target);
        }
        state.update()
    };
    row_constant(rows::Offset, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_default(rows::Default, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_instruments(rows::Instrumented, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_reading((rows::Instrumented, Reading<5, 5>), f32) -> bool, |state, _u, _y| {
        let (instrumented, reading) = state;
        reading.step(instrumented).is_some()
    };
    row_batched(rows::Batched, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_batches(rows::Batched, f32) -> bool, |state, _u, _y| state.estimate().by_blocks;
    row_dead_zone(rows::DeadZone, f32) -> Outcome, |state, u, y| {
        state.update_inputs(rows::dead_zone_inputs(u), y)
    };
    row_valved(rows::Valved, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_full(rows::Full, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_exact(rows::Exact, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_bank(rows::Bank, f32) -> Outcome, |state, u, y| state.update_inputs([u], y);
    row_estimate(rows::Default, f32) -> [f32; 5], |state, _u, _y| state.theta();
    row_std(rows::Default, f32) -> [f32; 5], |state, _u, _y| state.estimate().std();
    row_readings(rows::Default, f32) -> Readings, |state, _u, _y| {
        let found = state.estimate();
        (found.theta(), found.std(), found.covariance(), found.physical(), found.physical_std())
    };
    row_exact_estimate(rows::Exact, f32) -> [f32; 5], |state, _u, _y| state.theta();
    row_retune((rows::Default, [FilteredTrends<3>; 2]), f32) -> bool, |state, _u, _y| {
        // Another filter in every call.
        let (identifier, [next, after]) = state;
        core::mem::swap(next, after);
        identifier.retune(after.clone(), 0.1).is_ok()
    };
    row_bare_3(Estimator<3>, &[f32; 3]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bare_4(Estimator<4>, &[f32; 4]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bare_5(Estimator<5>, &[f32; 5]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bare_6(Estimator<6>, &[f32; 6]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bounded_3(Bounded<3>, &[f32; 3]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bounded_4(Bounded<4>, &[f32; 4]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bounded_5(Bounded<5>, &[f32; 5]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bounded_6(Bounded<6>, &[f32; 6]) -> f32, |state, phi, psi| state.update(phi, psi);
}

/// All that is asked of a model, from one reading of the identifier.
pub(crate) type Readings = (
    [f32; 5],
    [f32; 5],
    [[f32; 5]; 5],
    Physical<3>,
    Option<[f32; 3]>,
);

/// The bare estimator with its covariance bounded.
#[derive(Clone)]
pub(crate) struct Bounded<const N: usize> {
    estimator: Estimator<N>,
    forgetting: StabilisedForgetting<N>,
}

impl<const N: usize> Bounded<N> {
    #[inline(always)]
    fn update(&mut self, phi: &[f32; N], psi: f32) -> f32 {
        let innovation = self.estimator.update(phi, psi);
        self.forgetting.apply(&mut self.estimator);
        innovation
    }
}

pub(crate) fn bare<const N: usize>() -> Estimator<N> {
    Estimator::new([0.0; N], [1000.0; N], 0.999)
}

pub(crate) fn bounded<const N: usize>() -> Bounded<N> {
    Bounded {
        estimator: bare(),
        forgetting: StabilisedForgetting::new([0.0; N], 0.999),
    }
}
