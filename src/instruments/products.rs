//! Sums of products of instruments and rows.

/// Sums of z phi' and of z psi.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Products<const N: usize, const R: usize> {
    pub(crate) phi: [[f32; N]; R],
    pub(crate) psi: [f32; R],
}

impl<const N: usize, const R: usize> Products<N, R> {
    pub(crate) const ZERO: Self = Self {
        phi: [[0.0; N]; R],
        psi: [0.0; R],
    };

    /// Adds the products of a row.
    #[inline(always)]
    pub(super) fn add_row(&mut self, z: &[f32; R], phi: &[f32; N], psi: f32) {
        for r in 0..R {
            for j in 0..N {
                self.phi[r][j] += z[r] * phi[j];
            }
            self.psi[r] += z[r] * psi;
        }
    }

    /// The last regressor, and instrument, counts no more: its parameter is `value`.
    pub(super) fn settle_last(&mut self, value: f32) {
        for (phi, psi) in self.phi.iter_mut().zip(&mut self.psi) {
            if let Some(phi) = phi.last_mut() {
                *psi -= value * *phi;
                *phi = 0.0;
            }
        }
        if let (Some(phi), Some(psi)) = (self.phi.last_mut(), self.psi.last_mut()) {
            (*phi, *psi) = ([0.0; N], 0.0);
        }
    }

    /// `own` times these plus `weight` times others.
    #[inline(never)]
    pub(crate) fn add(&mut self, own: f32, other: &Self, weight: f32) {
        let sums = self.phi.as_flattened_mut();
        for (sum, value) in sums.iter_mut().zip(other.phi.as_flattened()) {
            *sum = own * *sum + weight * value;
        }
        for (sum, value) in self.psi.iter_mut().zip(&other.psi) {
            *sum = own * *sum + weight * value;
        }
    }
}
