//! The sine against its formula in double precision, and against its limits.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::*;

const STEP: f32 = 1e-3;

/// Position, velocity, acceleration and jerk of a unit sine about zero at `t`, by central
/// differences of the formula.
fn exact(frequency: f64, periods: f64, t: f64) -> [f64; 4] {
    let position = |t: f64| {
        let x = (t * frequency / periods).clamp(0.0, 1.0);
        let blend = x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x * x * x);
        blend * libm::sin(2.0 * core::f64::consts::PI * frequency * t)
    };
    let h = 2e-3 / frequency;
    let [p3, p2, p1, p0, m1, m2, m3] =
        [3.0, 2.0, 1.0, 0.0, -1.0, -2.0, -3.0].map(|k| position(t + k * h));
    [
        p0,
        (45.0 * (p1 - m1) - 9.0 * (p2 - m2) + (p3 - m3)) / (60.0 * h),
        (270.0 * (p1 + m1) - 27.0 * (p2 + m2) + 2.0 * (p3 + m3) - 490.0 * p0) / (180.0 * h * h),
        ((m3 - p3) + 8.0 * (p2 - m2) - 13.0 * (p1 - m1)) / (8.0 * h * h * h),
    ]
}

fn limits(velocity: f32, acceleration: f32, jerk: f32) -> MotionLimits {
    MotionLimits {
        velocity,
        acceleration,
        jerk,
    }
}

#[test]
fn a_sine_is_its_formula_with_all_derivatives() {
    let wide = limits(1e9, 1e9, 1e9);
    for (frequency, wanted, centre) in [(0.5_f32, 20.0_f32, 100.0_f32), (2.0, -3.0, -50.0)] {
        let mut sine = Sine::new(centre, wanted, frequency, &wide, STEP);
        let w = 2.0 * core::f32::consts::PI * frequency;
        for k in 1..=libm::roundf(3.0 / (frequency * STEP)) as usize {
            let found = sine.next(STEP);
            let t = f64::from(STEP) * k as f64;
            let expected = exact(frequency.into(), 1.0, t);
            let found = [
                found.position - centre,
                found.velocity,
                found.acceleration,
                found.jerk,
            ];
            for (j, (found, expected)) in found.into_iter().zip(expected).enumerate() {
                let size = f64::from(wanted.abs() * libm::powf(w, j as f32));
                let error = (f64::from(found) - f64::from(wanted) * expected).abs();
                assert!(
                    error < 3e-4 * size,
                    "{frequency} {t} {j}: {found} {expected}"
                );
            }
        }
        // After three periods the phasor is where it began, and on the unit circle.
        let [c, s] = sine.phase;
        assert!((c - 1.0).abs() < 1e-4 && s.abs() < 1e-3, "{c} {s}");
    }
}

/// Largest velocity, acceleration and jerk of a sine of one at this frequency over six periods.
fn largest(sine: &mut Sine, frequency: f32) -> [f32; 3] {
    let mut most = [0.0_f32; 3];
    for _ in 0..(6.0 / (frequency * STEP)) as usize {
        let now = sine.next(STEP);
        for (most, now) in most
            .iter_mut()
            .zip([now.velocity, now.acceleration, now.jerk])
        {
            *most = most.max(now.abs());
        }
    }
    most
}

#[test]
fn a_sine_grows_as_fast_as_the_limits_allow_and_within_them() {
    let frequency = 0.8;
    let w = 2.0 * core::f32::consts::PI * frequency;
    // Each of the three limits alone, then the others far away.
    for which in 0..3 {
        let of = |k: usize| {
            if k == which {
                libm::powf(w, 1.0 + k as f32)
            } else {
                1e9
            }
        };
        let limits = limits(of(0), of(1), of(2));
        let most = Sine::max_amplitude(frequency, &limits);
        assert!((most - 1.0).abs() < 0.02, "{which}: {most}");
        let mut growths = [0.0; 2];
        for (share, growth) in [0.999_f32, 0.6].into_iter().zip(&mut growths) {
            let mut sine = Sine::new(0.0, -share * most, frequency, &limits, STEP);
            *growth = sine.growth / (frequency * STEP);
            let found = largest(&mut sine, frequency);
            for (k, found) in found.into_iter().enumerate() {
                assert!(
                    found <= 1.001 * of(k),
                    "{which} {share} {k}: {found} of {}",
                    of(k)
                );
            }
        }
        // What is far within the limits grows in a period; what just keeps them, more slowly, where
        // the growth adds to the derivative.
        let slowest = if which == 0 { 1.0 } else { 0.25 };
        assert_eq!(growths, [slowest, 1.0], "{which}");
        // Where the limits allow less than is asked, it grows as slowly as it can.
        let wild = Sine::new(0.0, 5.0 * most, frequency, &limits, STEP);
        assert_eq!(wild.growth, frequency * STEP / 4.0);
    }
}
