//! How much of the noise is taken out, and what that leaves of the residual.

use super::*;
use crate::readout::beginning::Considered;

const P: Matrix<3> = [
    [0.04, 0.01, 0.005],
    [0.01, 0.09, -0.02],
    [0.005, -0.02, 0.25],
];

fn noise(white: Option<f32>) -> Noise<2> {
    Noise {
        moments: NoiseMoments {
            matrix: [[2.0, 0.3], [0.3, 1.0]],
            vector: [0.2, -0.1],
            top: 3.0,
        },
        spread: 3.0,
        residual: 0.5,
        white,
        lucky: false,
    }
}

#[test]
fn without_a_correction_everything_is_that_of_the_recursion() {
    let found: Compensated<2, 3> = Compensated {
        theta: [1.0; 3],
        correction: None,
        left: [0.0; 3],
        residual: noise(None).split(1.0, 100.0, 0.02),
        in_doubt: [[0.0; 3]; 2],
        considered: None,
    };
    assert_eq!((found.covariance(&P), found.gain(&P)), (P, P));
    assert_eq!(
        (found.share(), found.covariance_row(&P, 1)),
        (1.0, Some(P[1]))
    );
    assert_eq!(found.covariance_row(&P, 3), None);
    // Nothing is white, all of it counts once.
    let Residual {
        shaped,
        even,
        significance,
    } = found.residual;
    assert_eq!((shaped, even, significance), (0.0, 0.5, 0.5));
}

#[test]
fn a_correction_is_read_in_its_three_ways() {
    let correction = Correction::of(&[1.0, -2.0, 0.5], &P, &noise(None).moments, 3.0, 0.9);
    let found = Compensated {
        theta: [1.0; 3],
        correction,
        left: [0.0; 3],
        residual: noise(None).split(1.0, 100.0, 0.02),
        in_doubt: [[0.0; 3]; 2],
        considered: None,
    };
    let (gain, covariance) = (found.gain(&P), found.covariance(&P));
    for i in 0..3 {
        assert!(covariance[i][i] > gain[i][i] && gain[i][i] > P[i][i]);
        let row = found.covariance_row(&P, i).expect("a row");
        for j in 0..3 {
            assert!((row[j] - covariance[i][j]).abs() < 1e-6);
        }
    }
    assert_eq!(found.covariance_row(&P, 3), None);
}

#[test]
fn few_rows_know_no_share_of_noise() {
    for (rows, share) in [(0.0, 0.0), (2.0, 0.0), (8.0, 0.5), (200.0, 0.9)] {
        assert!((known_share(rows) - share).abs() < 1e-6, "{rows}");
    }
    // Of however many rows, some of a direction is left.
    let most = known_share(f32::MAX.sqrt());
    assert!(most <= 1.0 && known_share(1e6) < 1.0 - 1e-3);
}

#[test]
fn the_residual_is_split_into_noise_and_the_rest() {
    // White noise of 0.1 explains 0.3 of 0.5; chance alone 4 sqrt(2/n) of that more.
    let (top, angle) = (2.0, 0.05);
    let split = |white: f32, samples: f32| noise(Some(white)).split(top, samples, angle);
    let found = split(0.1, 3200.0);
    assert!((found.shaped - 4.0 * 0.1).abs() < 1e-6);
    // 2/(omega Delta) samples of the rest count as one.
    let (rest, chance) = (0.2, 0.3 * 4.0 * libm::sqrtf(2.0 / 3200.0));
    assert!((found.even - (rest - chance) * 40.0).abs() < 1e-4);
    assert!((found.significance - (0.5 + rest * 40.0)).abs() < 1e-4);
    // What is less than white noise makes is so by chance.
    let lucky = Noise {
        lucky: true,
        ..noise(None)
    };
    let found = lucky.split(top, 3200.0, angle);
    assert_eq!((found.shaped, found.even), (0.0, 0.5 * 40.0));
    // What noise explains leaves nothing; few samples leave nothing that is not chance.
    let found = split(0.2, 3200.0);
    assert_eq!((found.even, found.significance), (0.0, 0.5));
    for samples in [0.0, 1.0, 8.0] {
        assert_eq!(split(0.1, samples).even, 0.0);
    }
}

#[test]
fn what_is_only_considered_counts_beside_the_row_of_a_parameter() {
    let found = Compensated::<2, 3> {
        theta: [1.0; 3],
        correction: None,
        left: [0.0; 3],
        in_doubt: [[0.0; 3]; 2],
        residual: noise(None).split(1.0, 100.0, 0.02),
        considered: Some(Considered {
            direction: [0.2, 0.0, -1.0],
            variance: 0.5,
        }),
    };
    // Direction squared times the variance, over P.
    for (index, exact) in [
        (0, 1.0 + 0.02 / 0.04),
        (1, 1.0),
        (2, 1.0 + 0.5 / 0.25),
        (3, 1.0),
    ] {
        let share = found.considered(&P, index);
        assert!((share - exact).abs() < 1e-6, "{index}: {share}");
    }
    // A parameter that is known has no share.
    assert_eq!(found.considered(&[[0.0; 3]; 3], 0), 1.0);
}

#[test]
fn a_score_moves_the_estimate_by_the_gain() {
    let correction = Correction::of(&[1.0, -2.0, 0.5], &P, &noise(None).moments, 3.0, 0.9);
    let correction = correction.expect("a correction");
    let mut gain = P;
    correction.add_gain(&mut gain);
    let score = [0.3, -1.2, 0.7];
    let mut along = P.map(|row| dot(&row, &score));
    let before = along;
    correction.add_along(&score, &mut along);
    for i in 0..3 {
        assert!(
            (along[i] - dot(&gain[i], &score)).abs() < 1e-5,
            "{i}: {along:?}"
        );
    }
    assert!((along[1] - before[1]).abs() > 1e-3, "{along:?} {before:?}");
}
