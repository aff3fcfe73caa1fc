//! Roots of monic polynomials `s^m + c_{m-1} s^{m-1} + .. + c_0` of order up to 4.

use crate::math::complex::Complex;
use crate::math::polynomial::value_at;
use crate::math::{pow, raised, sqrt};

/// Largest order.
const ORDER: usize = 4;

/// Sum of the last steps, on roots whose product is 1, up to which the iteration counts as settled.
///
/// A k-fold root is found to the k-th root of the precision only: 2^-6 for four equal ones.
const SETTLED: f32 = 0.1;

/// Steps of the iteration; simple roots take about ten.
const STEPS: usize = 200;

/// Writes the roots of `c` into `roots`, by rising distance from zero; both have the length of the
/// order.
///
/// `None` where the order is above 4 or the iteration (Durand 1960, Kerner 1966) does not settle.
pub(crate) fn roots(c: &[f32], roots: &mut [Complex]) -> Option<()> {
    match (c, &mut *roots) {
        ([], _) => Some(()),
        ([c0], [root]) => {
            *root = Complex { re: -c0, im: 0.0 };
            Some(())
        }
        ([c0, c1], [near, far]) => {
            [*near, *far] = quadratic(*c0, *c1);
            Some(())
        }
        _ => {
            let (normal, scale) = normalise(c)?;
            let (found, moved) = iterate(normal.get(..c.len())?);
            for (root, found) in roots.iter_mut().zip(found) {
                *root = found;
            }
            clean(roots, scale);
            (moved < SETTLED).then_some(())
        }
    }
}

/// Roots of s^2 + c1 s + c0 without cancellation.
fn quadratic(c0: f32, c1: f32) -> [Complex; 2] {
    let half = 0.5 * c1;
    let discriminant = half * half - c0;
    if discriminant < 0.0 {
        let im = sqrt(-discriminant);
        return [Complex { re: -half, im }, Complex { re: -half, im: -im }];
    }
    let root = sqrt(discriminant);
    let far = if half < 0.0 {
        -half + root
    } else {
        -half - root
    };
    let near = if far != 0.0 { c0 / far } else { 0.0 };
    [near, far].map(|re| Complex { re, im: 0.0 })
}

/// The polynomial with a unit product of roots, and the unit of its roots.
fn normalise(c: &[f32]) -> Option<([f32; ORDER], f32)> {
    let order = c.len();
    let scale = pow(c.first()?.abs(), 1.0 / order as f32);
    let scale = if scale > 0.0 && scale.is_finite() {
        scale
    } else {
        1.0
    };
    let mut normal = [0.0; ORDER];
    for (i, (value, c)) in normal.get_mut(..order)?.iter_mut().zip(c).enumerate() {
        *value = c / raised(scale, order - i);
    }
    Some((normal, scale))
}

/// All roots at once by Durand's and Kerner's iteration, and the sum of the smallest steps.
fn iterate(normal: &[f32]) -> ([Complex; ORDER], f32) {
    // The bound spares every index below its check, and so the image a panic.
    let order = normal.len().min(ORDER);
    let mut roots = [Complex::ZERO; ORDER];
    // Starting values on a spiral that no symmetry of the polynomial can trap.
    let seed = Complex { re: 0.4, im: 0.9 };
    let mut start = Complex::ONE;
    for root in roots.iter_mut().take(order) {
        start = start.times(seed);
        *root = start;
    }
    // Near a multiple root rounding throws the iterates about: the calmest ones are the answer.
    let mut calmest = f32::MAX;
    let mut best = [Complex::ZERO; ORDER];
    for _ in 0..STEPS {
        let mut moved = 0.0;
        for i in 0..order {
            let product = (0..order)
                .filter(|j| *j != i)
                .fold(Complex::ONE, |p, j| p.times(roots[i].minus(roots[j])));
            if product.size() > 0.0 {
                let step = value_at(normal, roots[i]).times(product.inverse());
                roots[i] = roots[i].minus(step);
                moved += step.re.abs() + step.im.abs();
            }
        }
        if moved < calmest {
            calmest = moved;
            best = roots;
        }
        if moved < 1e-6 {
            break;
        }
    }
    (best, calmest)
}

/// Real roots without an imaginary part, in the unit `scale`, by rising distance from zero.
fn clean(roots: &mut [Complex], scale: f32) {
    for root in roots.iter_mut() {
        if root.im.abs() < 1e-4 * (root.re.abs() + 1e-3) {
            root.im = 0.0;
        }
        root.re *= scale;
        root.im *= scale;
    }
    roots.sort_unstable_by(|p, q| p.size().total_cmp(&q.size()));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found<const M: usize>(c: [f32; M]) -> [Complex; M] {
        let mut found = [Complex::ZERO; M];
        roots(&c, &mut found).unwrap();
        found
    }

    #[test]
    fn known_roots_by_rising_distance() {
        let close = |p: Complex, re: f32, im: f32| {
            (p.re - re).abs() < 1e-4 && (p.im.abs() - im).abs() < 1e-4
        };
        // (s + 1)(s + 2)(s + 3)(s + 4), and (s + 5)(s^2 + 2 s + 5).
        let four = found([24.0, 50.0, 35.0, 10.0]);
        for (k, root) in four.into_iter().enumerate() {
            assert!(close(root, -1.0 - k as f32, 0.0));
        }
        let three = found([25.0, 15.0, 7.0]);
        assert!(close(three[0], -1.0, 2.0) && close(three[2], -5.0, 0.0));
        assert!(close(found([-2.0])[0], 2.0, 0.0));
        assert!(close(found([1e-6, 1.0])[0], -1e-6, 0.0));
    }

    #[test]
    fn five_are_too_many() {
        assert_eq!(roots(&[1.0; 5], &mut [Complex::ZERO; 5]), None);
    }
}
