//! The initial state of a structure that has none, beside the recursion.
//!
//! The trends begin at rest at y(0). Its noise is in all of them until the slow pole of the filter
//! has forgotten it, as one more column `z_k = rho^k`, rho being the decay of that pole in a
//! sample. A structure with an initial state has that column. For any other three sums over the
//! rows, forgotten as they are, tell what the recursion with the column would have found:
//!
//! ```text
//! c = sum phi z        d = sum z^2        b = sum z psi
//! gamma = (b - c' theta) / S        theta <- theta - P c gamma        P <- P + P c c' P / S        S = d - c' P c + pi
//! ```
//!
//! with pi as what is known of gamma beforehand (the read-out). The recursion stays as it is: what
//! it would cost as a column in every sample it costs at the read-out, and with that knowledge it
//! takes less from the other parameters of a short record than a column of which nothing is known.
//!
//! Known as: partitioned least squares (Frisch, Waugh, Lovell). Lovell, J. American Statistical
//! Association 58 (1963).

/// A sum of squares below this, where a row at the beginning has 1, counts for nothing.
const NEGLIGIBLE: f32 = 1e-9;

/// The sums of the column that begins with 1, all normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beginning<const N: usize> {
    /// c.
    pub(crate) moments: [f32; N],
    /// d.
    pub(crate) square: f32,
    /// b.
    pub(crate) product: f32,
    /// Whether rows change the sums.
    pub(crate) lasts: bool,
}

impl<const N: usize> Beginning<N> {
    /// Nothing seen; with a column of its own a structure needs no sums, and nothing `lasts`.
    pub(crate) const fn new(lasts: bool) -> Self {
        Self {
            moments: [0.0; N],
            square: 0.0,
            product: 0.0,
            lasts,
        }
    }

    /// Takes a row with its column; what was before counts `forgetting` times.
    ///
    /// Cost: 5 instructions per parameter.
    pub(crate) fn take(&mut self, phi: &[f32; N], psi: f32, column: f32, forgetting: f32) {
        for (moment, phi) in self.moments.iter_mut().zip(phi) {
            *moment = forgetting * *moment + column * phi;
        }
        self.square = forgetting * self.square + column * column;
        self.product = forgetting * self.product + column * psi;
    }

    /// Ends where no row changes the sums any more: without a memory with the column, otherwise
    /// when they are forgotten.
    pub(crate) fn end(&mut self, column: f32, forgets: bool) {
        if column == 0.0 && !forgets {
            self.lasts = false;
        }
        if column == 0.0 && self.square < NEGLIGIBLE {
            *self = Self::new(false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::rls::Estimator;

    /// A row with its column, of a plant with a beginning of 0.5.
    fn row(k: usize) -> ([f32; 2], f32, f32) {
        let t = k as f32;
        let phi = [if k % 7 < 3 { 1.0 } else { -1.0 }, 0.3 + 0.01 * (t % 11.0)];
        let column = 0.97_f32.powi(k as i32);
        (phi, 2.0 * phi[0] - phi[1] + 0.5 * column, column)
    }

    #[test]
    fn the_sums_find_what_the_column_would() {
        for forgetting in [1.0, 0.98] {
            let mut beside = Beginning::new(true);
            let mut without = Estimator::<2>::new([0.0; 2], [1e3; 2], forgetting);
            let mut with = Estimator::<3>::new([0.0; 3], [1e3, 1e3, 10.0], forgetting);
            let mut known = 0.01;
            for k in 0..60 {
                let (phi, psi, column) = row(k);
                let _ = without.update(&phi, psi);
                let _ = with.update(&[phi[0], phi[1], column], psi);
                beside.take(&phi, psi, column, forgetting);
                known *= forgetting;
            }
            let (p, theta) = (without.covariances(), without.theta());
            let along = |i: usize| p[i][0] * beside.moments[0] + p[i][1] * beside.moments[1];
            let (mut s, mut found) = (beside.square + known, beside.product);
            for i in 0..2 {
                s -= beside.moments[i] * along(i);
                found -= beside.moments[i] * theta[i];
            }
            let gamma = found / s;
            assert!((gamma - with.theta()[2]).abs() < 1e-4, "{gamma}");
            for i in 0..2 {
                let corrected = theta[i] - along(i) * gamma;
                assert!((corrected - with.theta()[i]).abs() < 1e-4, "{corrected}");
                let variance = p[i][i] + along(i) * along(i) / s;
                assert!((variance / with.covariance(i, i) - 1.0).abs() < 1e-2);
            }
        }
    }

    #[test]
    fn it_ends_with_the_column_or_with_the_memory() {
        let mut beginning = Beginning::<1>::new(true);
        beginning.take(&[2.0], 3.0, 0.5, 1.0);
        beginning.end(0.5, false);
        assert!(beginning.lasts);
        beginning.end(0.0, false);
        assert_eq!(
            (beginning.lasts, beginning.moments, beginning.square),
            (false, [1.0], 0.25)
        );
        beginning.lasts = true;
        beginning.end(0.0, true);
        assert!(beginning.lasts);
        beginning.square = 0.5 * NEGLIGIBLE;
        beginning.end(0.0, true);
        assert_eq!(beginning, Beginning::new(false));
    }
}
