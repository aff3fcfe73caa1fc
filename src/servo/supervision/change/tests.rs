//! Changes of the variance of the innovation: which are found, when, and how often.

use super::*;

const DESIGN: ChangeDesign = ChangeDesign {
    fast_share: 1.0 / 30.0,
    slow_share: 1.0 / 2000.0,
    alarm_ratio: 9.0,
    pause: 100,
};

/// Samples until an alarm, of a detector that knows innovations of 1.
fn until(detector: &mut VarianceRatio, innovation: f32, settled: bool) -> Option<usize> {
    (0..20_000).position(|k| {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        detector.update(sign * innovation, settled)
    })
}

fn usual() -> VarianceRatio {
    let mut detector = VarianceRatio::new(&DESIGN);
    assert_eq!(until(&mut detector, 1.0, true), None, "no change, no alarm");
    assert!((detector.fast - 1.0).abs() < 1e-3 && (detector.usual - 1.0).abs() < 1e-3);
    detector
}

#[test]
fn a_variance_beyond_the_ratio_is_found_and_one_within_is_not() {
    // 1 - (1 - 1/30)^k of the new variance has arrived after k samples.
    let expected = |square: f32| {
        (1..).find(|k| {
            let arrived = 1.0 - (1.0 - DESIGN.fast_share).powi(*k);
            let slow = 1.0 - (1.0 - DESIGN.slow_share).powi(*k - 1);
            1.0 + arrived * (square - 1.0) > 9.0 * (1.0 + slow * (square - 1.0))
        })
    };
    for innovation in [4.0_f32, 10.0] {
        let found = until(&mut usual(), innovation, true).map(|k| k as i32 + 1);
        assert_eq!(found, expected(innovation * innovation), "{innovation}");
    }
    // Nine times the variance would be just enough, if the usual one stood still.
    assert_eq!(until(&mut usual(), 3.0, true), None);
    assert_eq!(until(&mut usual(), 0.0, true), None);
}

#[test]
fn an_alarm_is_followed_by_a_pause_and_by_another_usual_variance() {
    let mut detector = usual();
    let alarm = until(&mut detector, 10.0, true);
    assert!(alarm.is_some());
    assert_eq!(detector.usual, detector.fast);
    // The same innovations are the usual ones from then on.
    assert_eq!(until(&mut detector, 10.0, true), None);
    // A change within the pause is reported at its end.
    let mut detector = usual();
    let _ = until(&mut detector, 10.0, true);
    let next = until(&mut detector, 1e3, true);
    assert_eq!(next, Some(DESIGN.pause as usize - 1));
}

#[test]
fn nothing_is_an_alarm_before_the_loop_is_settled_or_a_variance_known() {
    assert_eq!(until(&mut usual(), 10.0, false), None);
    // The first innovation is the usual one, however large.
    let mut detector = VarianceRatio::new(&DESIGN);
    assert_eq!(until(&mut detector, 100.0, true), None);
    // No innovation is no change, nor is the first one after it.
    let mut silent = VarianceRatio::new(&DESIGN);
    assert_eq!(until(&mut silent, 0.0, true), None);
    assert_eq!(until(&mut silent, 1.0, true), None);
    detector.restart();
    assert_eq!((detector.fast, detector.usual), (0.0, 0.0));
    assert_eq!(until(&mut detector, 1.0, true), None);
}
