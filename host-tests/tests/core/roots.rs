//! Polynomials with known roots, and how far found poles lie from them.

use trendid::TransferFunction;
use trendid::model::Pole;
use trendid_host_tests::plants::polynomial::product;

/// A real root or a pair, in rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Root {
    Real(f64),
    Pair(f64, f64),
}

/// Coefficients, ascending and without the leading one, and the roots in the plane.
pub(crate) fn expand(roots: &[Root]) -> (Vec<f64>, Vec<(f64, f64)>) {
    let mut polynomial = vec![1.0];
    let mut plane = Vec::new();
    for root in roots {
        match *root {
            Root::Real(re) => {
                polynomial = product(&polynomial, &[-re, 1.0]);
                plane.push((re, 0.0));
            }
            Root::Pair(re, im) => {
                polynomial = product(&polynomial, &[re * re + im * im, -2.0 * re, 1.0]);
                plane.push((re, im));
                plane.push((re, -im));
            }
        }
    }
    polynomial.pop();
    (polynomial, plane)
}

pub(crate) fn transfer<const M: usize>(a: &[f64]) -> TransferFunction<M, 1> {
    TransferFunction {
        a: core::array::from_fn(|i| a[i] as f32),
        b: [[1.0; M]],
        constant: 0.0,
    }
}

/// Largest distance of a found pole to its partner, each root used once, relative to the largest
/// root.
pub(crate) fn distance(found: &[Pole], plane: &[(f64, f64)]) -> f64 {
    assert_eq!(found.len(), plane.len());
    let size = plane
        .iter()
        .fold(0.0_f64, |s, (re, im)| s.max(re.hypot(*im)));
    let mut left: Vec<(f64, f64)> = plane.to_vec();
    let mut worst = 0.0_f64;
    for pole in found {
        let apart =
            |(re, im): &(f64, f64)| (f64::from(pole.re) - re).hypot(f64::from(pole.im) - im) / size;
        let nearest = (0..left.len())
            .min_by(|i, j| apart(&left[*i]).total_cmp(&apart(&left[*j])))
            .unwrap();
        worst = worst.max(apart(&left.swap_remove(nearest)));
    }
    worst
}
