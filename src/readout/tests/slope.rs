//! The map to the plane of s, and what it makes of a covariance.

use super::*;

/// Whether the covariance about theta, which is of the size of `scale`, goes through the slope of
/// the map.
fn goes_through_the_slope(theta: [f32; 3], scale: [f32; 3]) {
    // Trends of 20 ms samples: the map is no identity.
    let trends = crate::trends::ExactTrends::<3>::for_bandwidth(2e-2, BANDWIDTH).expect("a filter");
    let design = trends.design().clone();
    let structure = Structure::<3, 3, 1>::INTEGRATING;
    let found = Estimate {
        structure,
        theta,
        covariance: [[900.0, 20.0, 1e5], [20.0, 4.0, 1e3], [1e5, 1e3, 1e9]],
    };
    let mapped = estimate_in_s_plane(found.clone(), &design, &[false; 3]);
    assert!(
        !close(mapped.theta[1], theta[1], 0.01),
        "{:?}",
        mapped.theta
    );
    let slope: [[f32; 3]; 3] = core::array::from_fn(|j| {
        let step = 5e-3 * scale[j];
        let at = |sign: f32| {
            let mut theta = theta;
            theta[j] += sign * step;
            theta_in_s_plane(&theta, &structure, &design, &[false; 3])
        };
        let (up, down) = (at(1.0), at(-1.0));
        core::array::from_fn(|i| (up[i] - down[i]) / (2.0 * step))
    });
    for i in 0..3 {
        for j in 0..3 {
            let mut exact = 0.0;
            for k in 0..3 {
                for l in 0..3 {
                    exact += slope[k][i] * found.covariance[k][l] * slope[l][j];
                }
            }
            let size = (mapped.covariance[i][i] * mapped.covariance[j][j]).sqrt();
            let error = (mapped.covariance[i][j] - exact).abs();
            assert!(
                error < 0.02 * size,
                "{i} {j}: {exact} {:?}",
                mapped.covariance
            );
        }
    }
    // And back.
    let back = s_plane::theta_in_trend_plane(&mapped.theta, &structure, &design, &[false; 3]);
    assert!((0..3).all(|j| close(back[j], theta[j], 1e-3)), "{back:?}");
}

#[test]
fn a_covariance_goes_through_the_slope_of_the_map_to_the_s_plane() {
    goes_through_the_slope([400.0, 20.0, 1e6], [400.0, 20.0, 1e6]);
}

#[test]
fn a_numerator_of_0_is_known_by_the_slope_of_any_other() {
    goes_through_the_slope([400.0, 20.0, 0.0], [400.0, 20.0, 1e6]);
}

#[test]
fn what_a_parameter_was_told_to_be_it_stays_in_either_plane() {
    let structure = Structure::<3, 3, 1>::INTEGRATING;
    let (design, theta) = (filtered(), [4e4, 80.0, 1e6]);
    let both = |known: &[bool; 3]| {
        [
            theta_in_s_plane(&theta, &structure, &design, known),
            s_plane::theta_in_trend_plane(&theta, &structure, &design, known),
        ]
    };
    let free = both(&[false; 3]);
    for j in 0..3 {
        let mut known = [false; 3];
        known[j] = true;
        for (found, free) in both(&known).into_iter().zip(free) {
            assert!(free.iter().zip(theta).all(|(a, b)| *a != b), "{free:?}");
            for i in 0..3 {
                assert_eq!(found[i], if i == j { theta[i] } else { free[i] });
            }
        }
    }
}

#[test]
fn a_command_leads_to_the_same_speed_in_either_plane() {
    let structure = Structure::<3, 3, 1>::INTEGRATING;
    let theta = [4e4, 80.0, 1e6];
    let found = theta_in_s_plane(&theta, &structure, &filtered(), &[false; 3]);
    assert!(!close(found[2], theta[2], 1e-4), "{found:?}");
    assert!(
        close(found[2] / found[0], theta[2] / theta[0], 1e-5),
        "{found:?}"
    );
}
