//! Least squares in f64 by singular values, independent of any recursion.

use nalgebra::{DMatrix, DVector};

use crate::oracles::trends::{Hold, Scheme, applied, input_trend, output_trend};
use crate::plants::polynomial::delayed;

/// Terms of one input in a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct InputTerms {
    /// Powers `i` of the coefficients `b[i]` that exist, ascending.
    pub b: Vec<usize>,
    /// Delay in samples.
    pub delay: usize,
    /// Course between the samples.
    pub hold: Hold,
}

impl InputTerms {
    /// A held input without delay.
    pub fn held(b: &[usize]) -> Self {
        Self {
            b: b.to_vec(),
            delay: 0,
            hold: Hold::Zero,
        }
    }
}

/// Which coefficients a model has.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Order `m`.
    pub m: usize,
    /// Powers `i < m` of the coefficients `a[i]` that exist, ascending.
    pub a: Vec<usize>,
    /// Inputs.
    pub inputs: Vec<InputTerms>,
    /// Whether a constant stands on the right-hand side.
    pub constant: bool,
}

impl Structure {
    /// `b0 / (s (s^2 + a2 s + a1))`: parameters `[a1, a2, b0]`.
    pub fn servo() -> Self {
        Self {
            m: 3,
            a: vec![1, 2],
            inputs: vec![InputTerms::held(&[0])],
            constant: false,
        }
    }

    /// First sample at which no raw trend reaches before the record.
    pub fn first_full(&self) -> usize {
        self.m + self.inputs.iter().map(|i| i.delay).max().unwrap_or(0)
    }
}

/// Rows `phi(k) theta = target(k)`; `theta` holds the `a` ascending, then each input's `b`
/// ascending, then the constant.
///
/// The columns of `a` are `-R_i y`, so that `theta` holds `a_i` itself, where (12) of the paper
/// holds `-a_i`, descending.
#[derive(Clone, Debug)]
pub struct Regression {
    /// One row per sample.
    pub phi: DMatrix<f64>,
    /// Trend of order `m` of the output.
    pub target: DVector<f64>,
}

impl Regression {
    /// Raw trends of a record (`f` absent) or trends filtered by `1/R_A` (`f` ascending, monic,
    /// length `m + 1`).
    ///
    /// Rows before [`Structure::first_full`] are left out. The filter starts at rest.
    ///
    /// # Panics
    /// When the numbers of inputs differ or the record is shorter than the structure.
    pub fn new(
        structure: &Structure,
        scheme: Scheme,
        f: Option<&[f64]>,
        dt: f64,
        u: &[&[f64]],
        y: &[f64],
    ) -> Self {
        assert_eq!(u.len(), structure.inputs.len(), "one sequence per input");
        let m = structure.m;
        let trend = |operator: &[f64], x: &[f64]| applied(operator, scheme, f, dt, x);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for &i in &structure.a {
            let mut column = trend(&output_trend(scheme, m, i, dt), y);
            column.iter_mut().for_each(|v| *v = -*v);
            columns.push(column);
        }
        for (input, u) in structure.inputs.iter().zip(u) {
            for &i in &input.b {
                let operator = input_trend(scheme, input.hold, m, i, dt);
                columns.push(trend(&delayed(&operator, input.delay), u));
            }
        }
        if structure.constant {
            let one = vec![1.0; y.len()];
            columns.push(trend(&input_trend(scheme, Hold::Zero, m, 0, dt), &one));
        }
        let target = trend(&output_trend(scheme, m, m, dt), y);
        let first = structure.first_full();
        Self {
            phi: DMatrix::from_fn(y.len() - first, columns.len(), |k, j| columns[j][k + first]),
            target: DVector::from_column_slice(&target[first..]),
        }
    }
}

/// Result of a least-squares fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Estimate.
    pub theta: DVector<f64>,
    /// `(Phi' W Phi)^-1`; times the noise variance of the target it is the covariance of `theta`.
    pub inverse: DMatrix<f64>,
    /// Weighted sum of squared residuals.
    pub loss: f64,
    /// Ratio of the largest to the smallest singular value of the column-scaled regressor.
    pub condition: f64,
}

/// `argmin sum_k weights[k] (target[k] - phi[k] theta)^2` by singular values of the column-scaled
/// rows, or nothing when the rows do not determine `theta` (condition above 1e12).
///
/// # Panics
/// When the numbers of rows, targets and weights differ.
pub fn least_squares(
    phi: &DMatrix<f64>,
    target: &DVector<f64>,
    weights: Option<&[f64]>,
) -> Option<Fit> {
    let (n, p) = phi.shape();
    assert_eq!(target.len(), n, "one target per row");
    let mut rows = phi.clone();
    let mut right = target.clone();
    if let Some(weights) = weights {
        assert_eq!(weights.len(), n, "one weight per row");
        for (k, w) in weights.iter().enumerate() {
            let root = w.sqrt();
            rows.row_mut(k).scale_mut(root);
            right[k] *= root;
        }
    }
    let lengths: Vec<f64> = rows.column_iter().map(|c| c.norm()).collect();
    if n < p || lengths.iter().any(|l| !(*l > 0.0 && l.is_finite())) {
        return None;
    }
    for (mut column, l) in rows.column_iter_mut().zip(&lengths) {
        column /= *l;
    }
    // Orthogonal triangularisation first: the singular values of the small triangle are those of
    // the tall matrix.
    let qr = rows.clone().qr();
    let rotated = qr.q().transpose() * &right;
    let svd = qr.r().svd(true, true);
    let (largest, smallest) = (svd.singular_values.max(), svd.singular_values.min());
    if !(smallest > 1e-12 * largest) {
        return None;
    }
    let scaled = svd.solve(&rotated, 0.0).ok()?;
    let loss = (&right - &rows * &scaled).norm_squared();
    let v = svd.v_t?.transpose();
    let spread = DMatrix::from_diagonal(&svd.singular_values.map(|s| 1.0 / (s * s)));
    let mut inverse = &v * spread * v.transpose();
    for i in 0..p {
        for j in 0..p {
            inverse[(i, j)] /= lengths[i] * lengths[j];
        }
    }
    Some(Fit {
        theta: DVector::from_fn(p, |i, _| scaled[i] / lengths[i]),
        inverse,
        loss,
        condition: largest / smallest,
    })
}

/// What a recursion with forgetting must have reached after all rows, computed at once.
///
/// Minimises `sum_k lambda^(N-1-k) (target[k] - phi[k] theta)^2`
/// `+ lambda^N sum_i ((theta_i - prior_i)/sd_i)^2 s^2`: the prior is one more row per parameter,
/// `sd` its standard deviation and `s` (`noise`) that of the target.
///
/// # Panics
/// When prior and deviations do not have one value per column.
pub fn recursive_equivalent(
    phi: &DMatrix<f64>,
    target: &DVector<f64>,
    lambda: f64,
    prior: &[f64],
    sd: &[f64],
    noise: f64,
) -> Option<Fit> {
    let (n, p) = phi.shape();
    assert!(prior.len() == p && sd.len() == p, "one prior per parameter");
    let mut rows = DMatrix::zeros(n + p, p);
    rows.view_mut((p, 0), (n, p)).copy_from(phi);
    let mut right = DVector::zeros(n + p);
    right.rows_mut(p, n).copy_from(target);
    for i in 0..p {
        rows[(i, i)] = noise / sd[i];
        right[i] = prior[i] * noise / sd[i];
    }
    let weights: Vec<f64> = (0..n + p)
        .map(|k| lambda.powi(n as i32 - (k as i32 + 1 - p as i32).max(0)))
        .collect();
    least_squares(&rows, &right, Some(&weights))
}

/// One-step prediction (9)-(10) of the output with the raw trends and fixed parameters, from sample
/// `first_full` on.
///
/// Returns the predictions with their sums of squared and absolute errors, `IQ` and `IV` of (11).
///
/// # Panics
/// When `theta` does not have one value per parameter.
pub fn evaluated_output(
    structure: &Structure,
    scheme: Scheme,
    theta: &[f64],
    dt: f64,
    u: &[&[f64]],
    y: &[f64],
) -> (Vec<f64>, f64, f64) {
    let regression = Regression::new(structure, scheme, None, dt, u, y);
    assert_eq!(
        theta.len(),
        regression.phi.ncols(),
        "one value per parameter"
    );
    let first = structure.first_full();
    let m = structure.m;
    // alpha = sum r0_i a_i collects the coefficients of y(k).
    let newest = |i| output_trend(scheme, m, i, dt)[0];
    let alpha = newest(m)
        + structure
            .a
            .iter()
            .zip(theta)
            .map(|(&i, a)| newest(i) * a)
            .sum::<f64>();
    let predicted = &regression.phi * DVector::from_column_slice(theta);
    // The equation error is alpha (y - y_hat).
    let y_hat: Vec<f64> = (0..regression.target.len())
        .map(|k| y[k + first] - (regression.target[k] - predicted[k]) / alpha)
        .collect();
    let errors = || y_hat.iter().zip(&y[first..]).map(|(p, y)| y - p);
    let iq = errors().map(|e| e * e).sum();
    let iv = errors().map(f64::abs).sum();
    (y_hat, iq, iv)
}

#[cfg(test)]
mod tests;
