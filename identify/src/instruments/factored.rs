//! Equations with rows and columns brought to size one.

use nalgebra::{DMatrix, DVector, Dyn, FullPivLU};

/// A matrix ready to solve, with rows and columns brought to size one.
pub(crate) struct Factored {
    rows: Vec<f64>,
    columns: Vec<f64>,
    lu: FullPivLU<f64, Dyn, Dyn>,
}

impl Factored {
    /// `None` where a row or a column is empty or not finite.
    pub(crate) fn new(matrix: &DMatrix<f64>) -> Option<Self> {
        let (rows, columns) = sizes(matrix)?;
        let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
            matrix[(i, j)] / (rows[i] * columns[j])
        });
        Some(Self {
            rows,
            columns,
            lu: scaled.full_piv_lu(),
        })
    }

    /// `M^-1 s`; `None` where M is singular.
    pub(crate) fn solve(&self, s: &DVector<f64>) -> Option<DVector<f64>> {
        let s = DVector::from_fn(s.len(), |i, _| s[i] / self.rows[i]);
        let found = self.lu.solve(&s)?;
        Some(DVector::from_fn(s.len(), |j, _| found[j] / self.columns[j]))
    }

    /// `M^-1 S M^-T` of a symmetric S; `None` where M is singular.
    pub(crate) fn sandwich(&self, scores: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let half = self.solve_columns(scores)?;
        self.solve_columns(&half.transpose())
    }

    /// `M^-1 G`; `None` where M is singular.
    pub(crate) fn solve_columns(&self, matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let columns: Option<Vec<DVector<f64>>> = matrix
            .column_iter()
            .map(|column| self.solve(&column.into_owned()))
            .collect();
        Some(DMatrix::from_columns(&columns?))
    }
}

/// Divisors that bring every row and column to a largest entry of about one.
pub(super) fn sizes(matrix: &DMatrix<f64>) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = matrix.nrows();
    let mut columns = vec![1.0; n];
    let mut rows = vec![1.0; n];
    for _ in 0..3 {
        for i in 0..n {
            rows[i] = (0..n)
                .map(|j| (matrix[(i, j)] / columns[j]).abs())
                .fold(0.0, f64::max);
        }
        if !rows.iter().all(|r| *r > 0.0 && r.is_finite()) {
            return None;
        }
        for j in 0..n {
            columns[j] = (0..n)
                .map(|i| (matrix[(i, j)] / rows[i]).abs())
                .fold(0.0, f64::max);
        }
        if !columns.iter().all(|r| *r > 0.0 && r.is_finite()) {
            return None;
        }
    }
    Some((rows, columns))
}
