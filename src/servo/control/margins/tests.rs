//! Margins against those that an open loop has by its formula.

use super::*;

/// Margins of `L = k e^(-j w T)/(j w)` along 4000 frequencies.
fn noted(k: f32, delay: f32) -> Margins {
    let mut margins = Margins::NONE;
    let mut last = Complex::ONE;
    for n in 1..4000 {
        let w = 0.002 * n as f32 + 0.0007;
        let (sin, cos) = (libm::sinf(w * delay), libm::cosf(w * delay));
        // k/(j w) (cos - j sin).
        let closed = Complex {
            re: 1.0 - k / w * sin,
            im: -k / w * cos,
        };
        margins.note(&last, &closed, w);
        last = closed;
    }
    margins
}

#[test]
fn an_integrator_behind_a_delay_has_the_margins_of_its_formula() {
    for (k, delay) in [(1.0_f32, 0.5_f32), (0.8, 1.0), (2.0, 0.3), (0.4, 1.0)] {
        let found = noted(k, delay);
        // |L| = 1 at w = k; there the phase is -90 degrees - k T.
        let phase = core::f32::consts::FRAC_PI_2 - k * delay;
        let chord = 2.0 * libm::sinf(0.5 * phase);
        // A chord stands for its arc: two terms of the series.
        let by_chord = chord * (1.0 + chord * chord / 24.0);
        assert!((found.phase - by_chord).abs() < 0.01, "{found:?} {phase}");
        assert!(
            (found.phase / phase - 1.0).abs() < 0.03,
            "{found:?} {phase}"
        );
        assert!((found.delay - found.phase / k).abs() < 0.01, "{found:?}");
        // The phase is -180 degrees at w = pi/(2 T), where |L| = 2 k T/pi.
        let gain = core::f32::consts::FRAC_PI_2 / (k * delay);
        assert!((found.gain / gain - 1.0).abs() < 0.01, "{found:?} {gain}");
        let least = (1..4000)
            .map(|n| {
                let w = 0.002 * n as f32 + 0.0007;
                let re = 1.0 - k / w * libm::sinf(w * delay);
                let im = k / w * libm::cosf(w * delay);
                libm::hypotf(re, im)
            })
            .fold(f32::INFINITY, f32::min);
        assert!(
            (found.sensitivity * least - 1.0).abs() < 1e-4,
            "{found:?} {least}"
        );
    }
}

#[test]
fn the_least_of_several_crossings_counts() {
    let at = |re: f32, im: f32| Complex { re: 1.0 + re, im };
    let mut margins = Margins::NONE;
    // Across the unit circle at 60 degrees from -1, then at 20, then at 40; further out between.
    for (degrees, w) in [(60.0_f32, 1.0), (20.0, 2.0), (40.0, 9.0)] {
        let angle = degrees * core::f32::consts::PI / 180.0;
        let (s, c) = (libm::sinf(angle), libm::cosf(angle));
        margins.note(&at(-1.01 * c, -1.01 * s), &at(-0.999 * c, -0.999 * s), w);
    }
    let degrees = margins.phase * 180.0 / core::f32::consts::PI;
    assert!((degrees - 20.0).abs() < 0.2, "{margins:?}");
    // 40 degrees at nine times the frequency leave the least time.
    let delay = 40.0 * core::f32::consts::PI / 180.0 / 9.0;
    assert!((margins.delay / delay - 1.0).abs() < 0.02, "{margins:?}");
    // Crossings of the real axis: beyond -1 and right of zero there is no gain margin.
    for (real, gain) in [
        (-1.2, f32::INFINITY),
        (0.3, f32::INFINITY),
        (-0.5, 2.0),
        (-0.2, 2.0),
    ] {
        margins.note(&at(real, -0.01), &at(real, 0.01), 1.0);
        assert!(
            margins.gain == gain || (margins.gain / gain - 1.0).abs() < 1e-5,
            "{real}"
        );
    }
}
