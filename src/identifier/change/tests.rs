//! A change among innovations, and what is none.

use super::*;

/// Ten times 20/omega: what is new does not pass for usual.
const LAMBDA: f32 = 0.9999;

fn shares(least: f32) -> Shares {
    Shares::new(0.02, least)
}

/// Feeds rows of a motion of one until a change is found; `size` is that of the innovation.
fn until(
    detector: &mut ChangeDetector,
    size: f32,
    samples: u32,
    least: f32,
    spread: f32,
) -> Option<u32> {
    (0..samples).find(|k| {
        let sign = if (k / 60) % 2 == 0 { 1.0 } else { -1.0 };
        detector.found([sign * size, sign], shares(least), || spread)
    })
}

#[test]
fn a_detector_is_blind_for_as_long_as_it_was_told() {
    for blind in [0, 1, 700] {
        let mut detector = ChangeDetector::new(LAMBDA, blind);
        // What is new from the first sample on is usual, and no change.
        assert_eq!(until(&mut detector, 0.01, 20_000, 0.0, 0.0), None);
        let mut other = ChangeDetector::new(LAMBDA, 0);
        assert_eq!(until(&mut other, 0.01, 20_000, 0.0, 0.0), None);
        other.blind = blind;
        let found = until(&mut other, 0.5, 4000, 0.0, 0.0).expect("a change");
        let at_once = until(&mut detector, 0.5, 4000, 0.0, 0.0).expect("a change");
        assert_eq!(found, blind.max(at_once), "{blind}");
        other.answer(LAMBDA, 33, blind);
        assert_eq!(other.settling, 33);
        assert_eq!(other.blind, blind);
    }
}

#[test]
fn a_change_is_unusual_it_matters_and_it_is_more_than_noise_and_ignorance() {
    let usual = || {
        let mut detector = ChangeDetector::new(LAMBDA, 0);
        assert_eq!(until(&mut detector, 0.02, 20_000, 0.0, 0.0), None);
        detector
    };
    // Twelve times the usual mean square, after the lag: the same motion at another size.
    assert_eq!(
        until(&mut usual(), 0.06, 3000, 0.0, 0.0),
        None,
        "nine times"
    );
    assert!(
        until(&mut usual(), 0.11, 3000, 0.0, 0.0).is_some(),
        "thirty times"
    );
    // Less than a tenth of the motion does not matter.
    assert_eq!(until(&mut usual(), 0.09, 3000, 0.0, 0.0), None);
    // A model that is not known makes innovations of 1 + phi' P phi.
    assert_eq!(until(&mut usual(), 0.15, 3000, 0.0, 5.0), None);
    assert!(until(&mut usual(), 0.15, 3000, 0.0, 0.5).is_some());
    // Nor is it a change within twelve times what is always allowed for.
    let whole = 0.11 * 0.11;
    assert_eq!(until(&mut usual(), 0.11, 3000, whole / 12.0, 0.0), None);
    assert!(until(&mut usual(), 0.11, 3000, 0.2 * whole / 12.0, 0.0).is_some());
}

#[test]
fn what_is_unusual_is_twelve_times_what_noise_and_ignorance_make() {
    // Without a share of the newest row the mean squares stay what they are put to.
    let still = Shares {
        carried: 1.0,
        lag: 0.0,
        power: 0.0,
        least: 0.0,
    };
    let mut usual = ChangeDetector::new(LAMBDA, 0);
    for _ in 0..50_000 {
        usual.usual.update(1.0);
    }
    for spread in [0.0, 0.5, 5.0] {
        for (share, found) in [(0.98, false), (1.02, true)] {
            let mut detector = usual.clone();
            detector.power = [12.0 * (1.0 + spread) * share, 1.0];
            assert_eq!(
                detector.found([0.0; 2], still, || spread),
                found,
                "{spread} {share}"
            );
        }
    }
    // And a hundredth of the motion, squared.
    for (motion, found) in [(0.99e4, true), (1.01e4, false)] {
        let mut detector = usual.clone();
        detector.power = [100.0, motion];
        assert_eq!(detector.found([0.0; 2], still, || 0.0), found);
    }
}

#[test]
fn shares_are_those_of_their_time_constants() {
    let shares = Shares::new(0.02, 3.0);
    // 1/(2 omega) and 4/omega, in samples of 0.02/omega.
    for (share, samples) in [(shares.lag, 25.0), (shares.power, 200.0)] {
        assert!((share - 1.0 / (1.0 + samples)).abs() < 1e-6);
    }
    assert_eq!(shares.least, 3.0);
}

#[test]
fn rows_are_left_out_until_little_of_the_old_drive_is_carried() {
    let shares = Shares::new(0.02, 1e-9);
    let settling = 195; // three time constants of 1/(0.77 omega)
    let left_out = |before: f32, psi: f32| {
        let mut detector = ChangeDetector::new(LAMBDA, 0);
        detector.power = [0.1, before * before];
        detector.answer(LAMBDA, settling, 0);
        let mut samples = 0;
        while detector.settling > 0 {
            detector.settle(psi, shares);
            samples += 1;
        }
        assert_eq!(detector.power, [0.0; 2]);
        samples
    };
    assert_eq!(left_out(1.0, 1.1), settling);
    // ln(50) time constants of 65 samples more.
    let longer = left_out(100.0, 1.0) - settling;
    assert!((250..270).contains(&longer), "{longer}");
    // Whatever the new drive does: until the square is below what is always allowed for.
    let longest = left_out(100.0, 0.0);
    assert!((970..1000).contains(&longest), "{longest}");
}

#[test]
fn what_has_decayed_becomes_zero() {
    let mut detector = ChangeDetector::new(LAMBDA, 0);
    detector.lagged = [1e-16, -1e-14];
    detector.power = [1e-31, 1e-29];
    detector.flush_lagged();
    detector.flush_power();
    assert_eq!(
        (detector.lagged, detector.power),
        ([0.0, -1e-14], [0.0, 1e-29])
    );
}

#[test]
fn the_former_drive_is_all_there_is_until_a_row_of_the_new_one() {
    let mut detector = ChangeDetector::new(LAMBDA, 0);
    let behind = |alone: bool, rows: f32| Former::behind(alone, rows, 1.0 - LAMBDA);
    assert_eq!(detector.former(LAMBDA), Former::NONE, "no change was found");
    for settling in [0, 1, 30] {
        detector.answer(LAMBDA, settling, 0);
        assert_eq!(detector.former(LAMBDA), behind(settling > 0, 0.0));
    }
    // What is left of it goes with the rows, which lose no more than the memory lets them.
    detector.answer(LAMBDA, 0, 0);
    assert_eq!(until(&mut detector, 0.01, 2000, 0.0, 0.0), None);
    let rows = detector.usual.samples();
    assert!((1000.0..=2000.0).contains(&rows), "{rows}");
    assert_eq!(detector.former(LAMBDA), behind(false, rows));
    detector.begin();
    assert_eq!(
        detector.former(LAMBDA),
        Former::NONE,
        "values of no drive before"
    );
}
