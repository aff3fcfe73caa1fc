//! The covariance of least squares under a residual that is not white.
//!
//! Known as: sandwich covariance. White, Econometrica 48 (1980); Ljung, System Identification
//! (1999), ch. 9.
//!
//! With R and S of the [residual's spectrum](super::residual_spectrum) the covariance is
//! `R^-1 S R^-1`. With `R = L L'` and `L^-1 S L^-T = Z Z'` the matrix `T = L^-T Z L'` gives
//! `T P T' = R^-1 S R^-1` where P is `R^-1`, and `T P T'` stays positive for any other P.

use crate::estimation::terms::{Parameter, index_of};
use crate::math::matrix::{
    Matrix, backward, cholesky, column, forward, forward_to, product, product_of_triangles,
    product_transposed, transposed,
};
use crate::math::sqrt;

/// T; `None` where R and S have no proper factors. Parameters that are not `free` are known and
/// stand apart.
#[inline(never)]
pub(crate) fn transform<const N: usize>(
    mut r: Matrix<N>,
    mut s: Matrix<N>,
    free: [bool; N],
) -> Option<Matrix<N>> {
    // Unit size for all that are free.
    let mut size = [1.0; N];
    for j in 0..N {
        if free[j] {
            if !(r[j][j] > 0.0 && r[j][j].is_finite() && s[j][j].is_finite()) {
                return None;
            }
            size[j] = 1.0 / sqrt(r[j][j]);
        }
    }
    for i in 0..N {
        for j in 0..N {
            if free[i] && free[j] {
                r[i][j] *= size[i] * size[j];
                s[i][j] *= size[i] * size[j];
            } else {
                let apart = if i == j { 1.0 } else { 0.0 };
                r[i][j] = apart;
                s[i][j] = apart;
            }
        }
    }
    let l = cholesky(&r)?;
    let z = cholesky(&whitened(&s, &l))?;
    let scaled = product_of_triangles(&z, &l);
    let columns: Matrix<N> = core::array::from_fn(|j| backward(&l, column(&scaled, j)));
    let mut transform = transposed(&columns);
    // T <- D T D^-1 with D = size.
    for i in 0..N {
        for j in 0..N {
            transform[i][j] *= size[i] / size[j];
        }
    }
    let finite = transform.iter().flatten().all(|v| v.is_finite());
    finite.then_some(transform)
}

/// The lower half of L^-1 S L^-T: the columns of S first, then its rows.
fn whitened<const N: usize>(s: &Matrix<N>, l: &Matrix<N>) -> Matrix<N> {
    let rows: Matrix<N> = core::array::from_fn(|j| forward(l, column(s, j)));
    core::array::from_fn(|j| forward_to(l, column(&rows, j), j + 1))
}

/// Noise counts this many times for a constant: in a short record it differs from the initial state
/// and from a command only above its own frequencies. Chosen on separate seeds with offsets of 0.1
/// to 10 %.
const SEPARATION: f32 = 1.5;

/// T P T' of least squares without the constant, plus the contribution of the constant at the
/// frequencies of the constant.
///
/// T does not know how a constant and the command resemble each other in a short record; P does.
pub(crate) fn sandwich<const N: usize>(
    t: &Matrix<N>,
    p: &Matrix<N>,
    parameters: &[Parameter; N],
) -> Matrix<N> {
    let constant = index_of(parameters, Parameter::Constant);
    let at = |matrix: &Matrix<N>, i: usize, j: usize| {
        matrix
            .get(i)
            .and_then(|row| row.get(j))
            .copied()
            .unwrap_or(0.0)
    };
    let Some(c) = constant.filter(|c| at(p, *c, *c) > 0.0) else {
        return product_transposed(&product(t, p), t);
    };
    let (own, share) = (at(p, c, c), at(t, c, c));
    let added: Matrix<N> =
        core::array::from_fn(|i| core::array::from_fn(|j| at(p, i, c) * (at(p, c, j) / own)));
    let mut without = *p;
    for i in 0..N {
        for j in 0..N {
            without[i][j] -= added[i][j];
        }
    }
    let mut seen = product_transposed(&product(t, &without), t);
    for i in 0..N {
        for j in 0..N {
            seen[i][j] += SEPARATION * share * share * added[i][j];
        }
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readout::residual_spectrum::ResidualSpectrum;

    /// A servo seen through a filter that is its own denominator with the slow pole 2: s^3 + 22
    /// s^2 + 440 s + 800.
    fn spectrum<'a>(units: &'a [f32; 4], theta: &'a [f32; 4]) -> ResidualSpectrum<'a, 3, 4> {
        ResidualSpectrum {
            parameters: [
                Parameter::Output { power: 1 },
                Parameter::Output { power: 2 },
                Parameter::Input { input: 0, power: 0 },
                Parameter::InitialState,
            ],
            units,
            theta,
            denominator: [0.0, 400.0, 20.0],
            filter: [800.0, 440.0, 22.0],
            natural: 20.0,
            duration: 1e6,
            slowest: 2.0,
        }
    }

    #[test]
    fn under_a_white_residual_the_covariance_is_that_of_least_squares() {
        let (units, theta) = ([400.0, 20.0, 4e5, 50.0], [400.0, 20.0, 1e6, 0.0]);
        let mut spectrum = spectrum(&units, &theta);
        spectrum.filter = [0.0, 400.0, 20.0];
        let (r, s) = spectrum.sums();
        let found = transform(r, s, [true; 4]).unwrap();
        for i in 0..4 {
            for j in 0..4 {
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((found[i][j] - unit).abs() < 1e-3, "{found:?}");
            }
        }
    }

    #[test]
    fn a_slow_pole_hides_noise_from_the_gain_most() {
        // |A/A_f|^2 = omega^2/(omega^2 + 4): small where C is seen, one where the damping is.
        let (units, theta) = ([400.0, 20.0, 4e5, 50.0], [400.0, 20.0, 1e6, 0.0]);
        let spectrum = spectrum(&units, &theta);
        let (r, s) = spectrum.sums();
        let found = transform(r, s, [true; 4]).unwrap();
        let share = |i: usize| s[i][i] / r[i][i];
        assert!(share(0) < share(1) && share(1) > 0.9 && share(3) < 0.7);
        // T R^-1 T' R = R^-1 S: the traces agree, in whatever units.
        let inverse = |column: [f32; 4]| -> [f32; 4] {
            let size: [f32; 4] = core::array::from_fn(|i| 1.0 / sqrt(r[i][i]));
            let scaled: Matrix<4> =
                core::array::from_fn(|i| core::array::from_fn(|j| r[i][j] * size[i] * size[j]));
            let l = cholesky(&scaled).unwrap();
            let mut x: [f32; 4] = core::array::from_fn(|i| column[i] * size[i]);
            for i in 0..4 {
                for k in 0..i {
                    x[i] -= l[i][k] * x[k];
                }
                x[i] /= l[i][i];
            }
            for i in (0..4).rev() {
                for k in i + 1..4 {
                    x[i] -= l[k][i] * x[k];
                }
                x[i] /= l[i][i];
            }
            core::array::from_fn(|i| x[i] * size[i])
        };
        let (mut left, mut right) = (0.0, 0.0);
        for i in 0..4 {
            right += inverse(core::array::from_fn(|k| s[k][i]))[i];
            // Row i of T R^-1 T' R.
            let row = inverse(found[i]);
            let back: [f32; 4] =
                core::array::from_fn(|j| (0..4).map(|k| row[k] * found[j][k]).sum());
            left += (0..4).map(|j| back[j] * r[j][i]).sum::<f32>();
        }
        assert!((left / right - 1.0).abs() < 1e-2, "{left} {right}");
    }

    #[test]
    fn what_a_constant_adds_counts_by_its_own_share() {
        let parameters = [Parameter::Input { input: 0, power: 0 }, Parameter::Constant];
        let (t, p) = ([[2.0, 3.0], [0.0, 5.0]], [[2.0, 1.0], [1.0, 1.0]]);
        // Without the constant the variance of the input is 2 - 1/1: 4 behind T. What it adds, 1
        // everywhere, counts by 5^2, half as much again.
        let wanted = [[41.5, 37.5], [37.5, 37.5]];
        assert_eq!(sandwich(&t, &p, &parameters), wanted);
        // The same in a unit of the constant that is half as large.
        let (t, p) = ([[2.0, 1.5], [0.0, 5.0]], [[2.0, 2.0], [2.0, 4.0]]);
        let wanted = [[41.5, 75.0], [75.0, 150.0]];
        assert_eq!(sandwich(&t, &p, &parameters), wanted);
        // A known constant adds nothing, and neither does one that is not there.
        let p = [[2.0, 0.0], [0.0, 0.0]];
        assert_eq!(sandwich(&t, &p, &parameters), [[8.0, 0.0], [0.0, 0.0]]);
    }

    #[test]
    fn known_parameters_stand_apart() {
        let (units, theta) = ([400.0, 20.0, 4e5, 50.0], [400.0, 20.0, 1e6, 0.0]);
        let (r, s) = spectrum(&units, &theta).sums();
        let found = transform(r, s, [true, false, true, true]).unwrap();
        for j in [0, 2, 3] {
            assert_eq!((found[1][j], found[j][1]), (0.0, 0.0));
        }
    }

    #[test]
    fn nonsense_gives_nothing() {
        let (units, theta) = (
            [400.0, 20.0, 4e5, 50.0],
            [f32::NAN, 20.0, f32::INFINITY, 0.0],
        );
        let mut spectrum = spectrum(&units, &theta);
        spectrum.denominator = [0.0, f32::NAN, 20.0];
        let (r, s) = spectrum.sums();
        assert_eq!(transform(r, s, [true; 4]), None);
    }
}
