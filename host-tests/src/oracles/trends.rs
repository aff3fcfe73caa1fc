//! Trends of the paper in f64: raw by polynomial products, filtered in two independent ways.
//!
//! Filtered trends put one stable filter on both sides of (5). With `F = 1/R_A`,
//! `R_A = sum f_i R_i`, `A_f = sum f_i s^i` of order `m`, the filtered trend `F R_i` is exactly
//! `z^i / A_f(z)`, where `z` is the scheme's derivative: a chain of `m` discrete integrators, see
//! [`chain_output`] and [`chain_held`].

use crate::plants::polynomial::{
    delayed, difference_equation, moving_sum, power, product, scaled, sum,
};

/// Scheme of discretisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// Forward differences, (4).
    Goodwin,
    /// Modified Tustin, (8).
    Tustin,
}

/// Course of the input between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hold {
    /// Held: `u(k)` until `k+1`, as the paper assumes.
    Zero,
    /// Straight lines between samples: the input is treated like the output.
    First,
}

/// Trend operator of the output, `R_i` of order `m`, in powers of `q^-1`: (4) or (8).
pub fn output_trend(scheme: Scheme, m: usize, i: usize, dt: f64) -> Vec<f64> {
    let differences = power(&[1.0, -1.0], i);
    let span = dt.powi((m - i) as i32);
    match scheme {
        Scheme::Goodwin => delayed(&scaled(&differences, span), m - i),
        Scheme::Tustin => {
            let means = power(&[1.0, 1.0], m - i);
            scaled(&product(&differences, &means), 2f64.powi(i as i32) * span)
        }
    }
}

/// Trend operator of the input, `P_i` of order `m` without delay, in powers of `q^-1`: (4) or (8);
/// `i < m`.
///
/// For a first-order hold `P_i = R_i` in both schemes.
pub fn input_trend(scheme: Scheme, hold: Hold, m: usize, i: usize, dt: f64) -> Vec<f64> {
    match (scheme, hold) {
        (Scheme::Goodwin, _) | (_, Hold::First) => output_trend(scheme, m, i, dt),
        (Scheme::Tustin, Hold::Zero) => {
            // R_i 2 q^-1 / (1 + q^-1): one mean fewer, one shift more.
            let differences = power(&[1.0, -1.0], i);
            let means = power(&[1.0, 1.0], m - i - 1);
            let factor = 2f64.powi(i as i32 + 1) * dt.powi((m - i) as i32);
            delayed(&scaled(&product(&differences, &means), factor), 1)
        }
    }
}

/// Denominator `R_A = sum f_i R_i` of the filter `F = 1/R_A`; `f` ascending, monic, of length
/// `m + 1`.
pub fn filter_denominator(scheme: Scheme, f: &[f64], dt: f64) -> Vec<f64> {
    let m = f.len() - 1;
    (0..=m).fold(Vec::new(), |r, i| {
        sum(&r, &scaled(&output_trend(scheme, m, i, dt), f[i]))
    })
}

/// Operator applied to a whole record from rest, raw (`f` absent) or filtered by `1/R_A`: "trend,
/// then filter".
pub fn applied(
    operator: &[f64],
    scheme: Scheme,
    f: Option<&[f64]>,
    dt: f64,
    x: &[f64],
) -> Vec<f64> {
    match f {
        None => moving_sum(operator, x),
        Some(f) => difference_equation(operator, &filter_denominator(scheme, f, dt), x),
    }
}

/// Filtered trends `0..=m` of the output by a chain of `m` integrators: row `i` is
/// `z^i / A_f(z) y`.
///
/// Tustin: trapezoids, `x_i(k) = x_i(k-1) + dt/2 (x_{i+1}(k) + x_{i+1}(k-1))`. Goodwin: forward
/// rectangles, `x_i(k+1) = x_i(k) + dt x_{i+1}(k)`. In both `x_m = y - sum_{i<m} f_i x_i`.
pub fn chain_output(scheme: Scheme, f: &[f64], dt: f64, y: &[f64]) -> Vec<Vec<f64>> {
    let m = f.len() - 1;
    let h = 0.5 * dt;
    let mut x = vec![0.0; m + 1];
    let mut rows = vec![Vec::with_capacity(y.len()); m + 1];
    for &y in y {
        match scheme {
            Scheme::Goodwin => {
                for i in 0..m {
                    x[i] += dt * x[i + 1];
                }
                x[m] = y - (0..m).map(|i| f[i] * x[i]).sum::<f64>();
            }
            Scheme::Tustin => {
                // x_i(k) = known_i + h^(m-i) x_m(k): solve the loop for x_m(k).
                let mut known = vec![0.0; m + 1];
                let mut loop_gain = 1.0;
                for i in (0..m).rev() {
                    known[i] = x[i] + h * x[i + 1] + h * known[i + 1];
                    loop_gain += f[i] * h.powi((m - i) as i32);
                }
                let top = (y - (0..m).map(|i| f[i] * known[i]).sum::<f64>()) / loop_gain;
                for i in 0..=m {
                    x[i] = known[i] + h.powi((m - i) as i32) * top;
                }
            }
        }
        for i in 0..=m {
            rows[i].push(x[i]);
        }
    }
    rows
}

/// Filtered trends `0..m` of a held input: row `i` is `z^i / A_f(z)` times `2 q^-1/(1+q^-1) u`
/// (Tustin) or `u` (Goodwin).
///
/// The factor turns the first trapezoid into the exact integral of a held input: `dt u(k-1)`.
pub fn chain_held(scheme: Scheme, f: &[f64], dt: f64, u: &[f64]) -> Vec<Vec<f64>> {
    let m = f.len() - 1;
    if scheme == Scheme::Goodwin {
        let mut rows = chain_output(scheme, f, dt, u);
        rows.pop();
        return rows;
    }
    let h = 0.5 * dt;
    let mut x = vec![0.0; m];
    let mut last = 0.0;
    let mut rows = vec![Vec::with_capacity(u.len()); m];
    for &u in u {
        // x_{m-1}(k) = x_{m-1}(k-1) + dt u(k-1) - h sum f_i (x_i(k) + x_i(k-1)); the others are
        // trapezoids of the next.
        let mut known = vec![0.0; m];
        let mut loop_gain = 1.0 + h * f[m - 1];
        for i in (0..m - 1).rev() {
            known[i] = x[i] + h * x[i + 1] + h * known[i + 1];
            loop_gain += h * f[i] * h.powi((m - 1 - i) as i32);
        }
        let past: f64 = (0..m).map(|i| f[i] * (x[i] + known[i])).sum();
        let top = (x[m - 1] + dt * last - h * past) / loop_gain;
        for i in 0..m {
            x[i] = known[i] + h.powi((m - 1 - i) as i32) * top;
            rows[i].push(x[i]);
        }
        last = u;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operators_of_order_two_as_printed() {
        let dt = 0.5;
        assert_eq!(output_trend(Scheme::Goodwin, 2, 1, dt), [0.0, 0.5, -0.5]);
        assert_eq!(output_trend(Scheme::Goodwin, 2, 2, dt), [1.0, -2.0, 1.0]);
        assert_eq!(output_trend(Scheme::Goodwin, 2, 0, dt), [0.0, 0.0, 0.25]);
        assert_eq!(output_trend(Scheme::Tustin, 2, 2, dt), [4.0, -8.0, 4.0]);
        assert_eq!(output_trend(Scheme::Tustin, 2, 1, dt), [1.0, 0.0, -1.0]);
        let held = |i| input_trend(Scheme::Tustin, Hold::Zero, 2, i, dt);
        assert_eq!(held(0), [0.0, 0.5, 0.5]);
        assert_eq!(held(1), [0.0, 2.0, -2.0]);
        assert_eq!(
            input_trend(Scheme::Goodwin, Hold::Zero, 2, 0, dt),
            [0.0, 0.0, 0.25]
        );
    }

    #[test]
    fn tustin_is_exact_for_a_first_order_step() {
        // y' = u held: (8) with m = 1 is 2 (y(k) - y(k-1)) = 2 dt u(k-1), an identity.
        let y_trend = output_trend(Scheme::Tustin, 1, 1, 0.1);
        let u_trend = input_trend(Scheme::Tustin, Hold::Zero, 1, 0, 0.1);
        assert_eq!((y_trend, u_trend), (vec![2.0, -2.0], vec![0.0, 0.2]));
    }
}
