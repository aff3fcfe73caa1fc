//! The formulas against elimination in double precision.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::*;
use crate::servo::control::oracle::{self, Dice, Oracle};

fn near(found: Complex, [re, im]: oracle::C, share: f64) -> bool {
    let size = (re * re + im * im).sqrt();
    let error = [f64::from(found.re) - re, f64::from(found.im) - im];
    error.iter().all(|error| error.abs() <= share * size)
}

#[test]
fn a_lag_is_a_turn() {
    for k in 0..4000 {
        let angle = 0.005 * k as f32;
        let found = lag(angle);
        let [re, im] = oracle::turn(-f64::from(angle));
        let error = (f64::from(found.re) - re)
            .abs()
            .max((f64::from(found.im) - im).abs());
        assert!(error < 1e-5, "{angle}: {error}");
    }
}

#[test]
fn the_controller_is_that_of_its_equations() {
    let mut dice = Dice(1);
    for _ in 0..200 {
        let (drive, poles) = dice.pair();
        let frequency = crate::math::sqrt(drive.a1);
        let compensator = Compensator::new(drive, &Responses::new(&drive), poles, frequency);
        let exact = Oracle::new(&drive, &poles, frequency);
        for w in [0.05, 0.3, 1.0, 3.0, 8.0_f32] {
            let late = lag(w * drive.delay);
            let (found, expected) = (compensator.at(w, late), exact.at(w.into()));
            assert!(
                near(found, expected, 2e-3),
                "{drive:?} {poles:?} {w}: {found:?} {expected:?}"
            );
            let (found, expected) = (
                integrated(Complex::ONE, drive.b0, w, late)
                    .times(receptance(drive.a1, drive.a2, w)),
                oracle::response(&drive, w.into(), 0.0),
            );
            assert!(
                near(found, expected, 1e-4),
                "{drive:?} {w}: {found:?} {expected:?}"
            );
        }
    }
}
