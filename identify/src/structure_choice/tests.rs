//! A lag that shows, and no delay in its place.

use super::*;

/// u and y of an axis whose velocity lags by 0.2 s, under drift, sampled every 10 ms.
fn axis() -> [Vec<f64>; 2] {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    let (mut u, mut y, mut level) = (Vec::new(), Vec::new(), 0.0);
    let (mut v, mut x, mut drift) = (0.0, 0.0, 0.0);
    for k in 0..6000 {
        if k % 150 == 0 {
            level = random() - 0.3 * x;
        }
        u.push(level);
        drift = 0.995 * drift + 2e-3 * random();
        y.push(x + drift);
        v += 0.05 * (level - v);
        x += 0.01 * v;
    }
    [u, y]
}

#[test]
fn a_lag_that_shows_is_found_and_no_delay_is_in_doubt() {
    let [u, y] = axis();
    let signals = Signals::held(0.01, &u, &y);
    let range = Range {
        max_order: 2,
        integrating: true,
        constant: true,
    };
    let selection = select(&signals, range, Options::default(), Freedom::default(), &());
    let selection = selection.expect("a structure");
    let recommended = &selection.candidates[selection.recommended];
    assert_eq!((recommended.structure.order, recommended.delay), (2, 0));
    assert!(selection.lag().is_none());
}
