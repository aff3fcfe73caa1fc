//! The physical reading of an estimate, with its bands.

use trendid_link::telemetry::Learned;

/// The reading of an estimate: value and two standard deviations of C, omega0 and xi, by the
/// covariance of a1, a2, b0.
///
/// C = b0/a1, omega0 = sqrt(a1), xi = a2/(2 omega0); to first order.
pub(super) fn reading(learned: &Learned) -> Option<[[f64; 2]; 3]> {
    let [a1, a2, b0] = learned.theta.map(f64::from);
    if !(a1 > 0.0) || b0 == 0.0 {
        return None;
    }
    let omega0 = a1.sqrt();
    let [c, xi] = [b0 / a1, a2 / (2.0 * omega0)];
    let [p11, p22, p33, p12, p13, _] = learned.covariance?.map(f64::from);
    let c_var = c * c * (p33 / (b0 * b0) + p11 / (a1 * a1) - 2.0 * p13 / (a1 * b0));
    let omega_var = 0.25 * p11 / a1;
    // d xi / d a2 = 1/(2 omega0), d xi / d a1 = -xi/(2 a1).
    let (d2, d1) = (0.5 / omega0, -0.5 * xi / a1);
    let xi_var = d2 * d2 * p22 + d1 * d1 * p11 + 2.0 * d1 * d2 * p12;
    let band = |variance: f64| 2.0 * variance.max(0.0).sqrt();
    Some([
        [c, band(c_var)],
        [omega0, band(omega_var)],
        [xi, band(xi_var)],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The propagation of the covariance, against differences of the reading itself over the square
    /// root of the covariance.
    #[test]
    fn the_bands_of_the_reading_are_those_of_the_covariance() {
        let theta = [410.0_f32, 18.0, 9.0e5];
        // P = L L', so that it is a covariance; unscented points give the variance of a function
        // that is nearly linear.
        let l = [
            [2.0_f64, 0.0, 0.0],
            [0.03, 0.1, 0.0],
            [1500.0, 200.0, 900.0],
        ];
        let p = |i: usize, j: usize| (0..3).map(|k| l[i][k] * l[j][k]).sum::<f64>();
        let at = |shift: [f64; 3]| {
            let moved: [f32; 3] = std::array::from_fn(|i| theta[i] + shift[i] as f32);
            let covariance = [p(0, 0), p(1, 1), p(2, 2), p(0, 1), p(0, 2), p(1, 2)];
            let learned = Learned {
                theta: moved,
                covariance: Some(covariance.map(|x| x as f32)),
                ..Learned::default()
            };
            reading(&learned).unwrap()
        };
        let here = at([0.0; 3]);
        for quantity in 0..3 {
            let variance: f64 = (0..3)
                .map(|k| {
                    let up = at(std::array::from_fn(|i| l[i][k]))[quantity][0];
                    let down = at(std::array::from_fn(|i| -l[i][k]))[quantity][0];
                    (0.5 * (up - down)).powi(2)
                })
                .sum();
            let [value, band] = here[quantity];
            assert!(value.is_finite());
            assert!(
                (band / (2.0 * variance.sqrt()) - 1.0).abs() < 0.01,
                "{quantity}"
            );
        }
    }
}
