//! The correction by its formulas, written out.

use super::*;

const MATRIX: Matrix<3> = [[2.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.0]];
const P: Matrix<3> = [
    [0.04, 0.01, 0.005],
    [0.01, 0.09, -0.02],
    [0.005, -0.02, 0.25],
];

fn noise(white: Option<f32>) -> Noise<3> {
    Noise {
        matrix: MATRIX,
        vector: [0.2, -0.1, 0.0],
        spread: 3.0,
        residual: 0.5,
        white,
    }
}

fn multiplied(a: &Matrix<3>, b: &Matrix<3>) -> Matrix<3> {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

#[test]
fn a_step_takes_the_bias_out_and_is_damped() {
    let bare = [1.0, -2.0, 0.5];
    for level in [0.01, 1.0, 100.0] {
        let (theta, transform, damping) = corrected(&bare, &P, &noise(None), level);
        let pm = multiplied(&P, &MATRIX);
        let trace: f32 = (0..3).map(|i| pm[i][i]).sum();
        let w = level / (1.0 + level * trace);
        assert!((damping - w * trace).abs() < 1e-6 && damping < 1.0);
        let bias: [f32; 3] = core::array::from_fn(|i| {
            (0..3).map(|j| MATRIX[i][j] * bare[j]).sum::<f32>() - noise(None).vector[i]
        });
        for i in 0..3 {
            let step: f32 = (0..3).map(|j| w * P[i][j] * bias[j]).sum();
            assert!((theta[i] - bare[i] - step).abs() < 1e-5, "{level} {i}");
            for j in 0..3 {
                let unit = if i == j { 1.0 } else { 0.0 };
                let expected = unit + 2.0 * w * pm[i][j];
                assert!((transform[i][j] - expected).abs() < 1e-5 * (1.0 + expected.abs()));
            }
        }
        let found = Compensated {
            theta,
            transform: Some(transform),
            left: [0.0; 3],
            residual: noise(None).split(1.0, 100.0, 0.02),
        };
        // All that follows from the transform.
        assert!((found.damping() - damping).abs() < 1e-5);
        let transposed = core::array::from_fn(|i| core::array::from_fn(|j| transform[j][i]));
        let all = multiplied(&multiplied(&transform, &P), &transposed);
        let gain = multiplied(&transform, &P);
        for i in 0..3 {
            let row = found.covariance_row(&P, i).expect("a row");
            for j in 0..3 {
                let near =
                    |found: f32, exact: f32| (found - exact).abs() < 1e-5 * (1.0 + exact.abs());
                assert!(near(found.covariance(&P)[i][j], all[i][j]) && near(row[j], all[i][j]));
                assert!(near(found.gain(&P)[i][j], 0.5 * (gain[i][j] + P[i][j])));
            }
        }
        assert_eq!(found.covariance_row(&P, 3), None);
    }
}

#[test]
fn without_a_correction_everything_is_that_of_the_recursion() {
    let found = Compensated {
        theta: [1.0; 3],
        transform: None,
        left: [0.0; 3],
        residual: noise(None).split(1.0, 100.0, 0.02),
    };
    assert_eq!((found.covariance(&P), found.gain(&P)), (P, P));
    assert_eq!(
        (found.damping(), found.covariance_row(&P, 1)),
        (0.0, Some(P[1]))
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
    // What noise explains leaves nothing; few samples leave nothing that is not chance.
    let found = split(0.2, 3200.0);
    assert_eq!((found.even, found.significance), (0.0, 0.5));
    for samples in [0.0, 1.0, 8.0] {
        assert_eq!(split(0.1, samples).even, 0.0);
    }
}
