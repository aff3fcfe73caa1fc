//! A model as its polynomials, and what they say of it.

use nalgebra::DMatrix;

use crate::estimate::Reading;

/// `A(s) y = sum_c B_c(s) u_c + constant`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polynomials {
    /// a_0 .. a_{m-1} of the monic denominator.
    pub a: Vec<f64>,
    /// b_0 .. of each input.
    pub b: Vec<Vec<f64>>,
    /// The constant on the right-hand side.
    pub constant: f64,
}

/// Real and imaginary part \[rad/s\].
pub(crate) type Pole = (f64, f64);

/// Roots of `s^n + c_{n-1} s^(n-1) + .. + c_0`, slowest first; `None` where they are not finite.
pub(crate) fn roots(coefficients: &[f64]) -> Option<Vec<Pole>> {
    let n = coefficients.len();
    // In units of a rate, so that all coefficients are of one size.
    let of = |i: usize| coefficients[i].abs().powf(1.0 / (n - i) as f64);
    let rate = (0..n).map(of).fold(0.0, f64::max);
    if !coefficients.iter().all(|c| c.is_finite()) || !rate.is_finite() {
        return None;
    }
    if rate == 0.0 {
        return Some(vec![(0.0, 0.0); n]);
    }
    let companion = DMatrix::from_fn(n, n, |i, j| match i + 1 {
        row if row == n => -coefficients[j] / rate.powi((n - j) as i32),
        next => f64::from(u8::from(next == j)),
    });
    let found = companion
        .try_schur(f64::EPSILON, 10_000)?
        .complex_eigenvalues();
    let mut roots: Vec<Pole> = found.iter().map(|p| (p.re * rate, p.im * rate)).collect();
    roots.sort_by(|p, q| {
        p.0.hypot(p.1)
            .total_cmp(&q.0.hypot(q.1))
            .then(p.1.total_cmp(&q.1))
    });
    Some(roots)
}

/// Coefficients of the monic polynomial with these roots, in conjugate pairs.
pub(crate) fn from_roots(roots: &[Pole]) -> Vec<f64> {
    // Ascending, complex until the end.
    let mut product = vec![(1.0, 0.0)];
    for (re, im) in roots {
        let mut next = vec![(0.0, 0.0); product.len() + 1];
        for (i, (x, y)) in product.iter().enumerate() {
            next[i + 1].0 += x;
            next[i + 1].1 += y;
            next[i].0 -= x * re - y * im;
            next[i].1 -= x * im + y * re;
        }
        product = next;
    }
    product.pop();
    product.into_iter().map(|(re, _)| re).collect()
}

impl Polynomials {
    /// The poles behind `integrators` poles at 0, slowest first.
    pub(crate) fn poles(&self, integrators: usize) -> Option<Vec<Pole>> {
        roots(&self.a[integrators..])
    }

    /// Zeros of an input, slowest first; none where its highest coefficient is 0.
    pub(crate) fn zeros(&self, input: usize) -> Vec<Pole> {
        let b = &self.b[input];
        match b.split_last() {
            Some((highest, lower)) if *highest != 0.0 && !lower.is_empty() => {
                let monic: Vec<f64> = lower.iter().map(|b| b / highest).collect();
                roots(&monic).unwrap_or_default()
            }
            _ => Vec::new(),
        }
    }

    /// Whether all poles behind the integrators are stable.
    pub fn is_stable(&self, integrators: usize) -> bool {
        self.poles(integrators)
            .is_some_and(|poles| poles.iter().all(|(re, _)| *re < 0.0))
    }

    /// Gain, natural frequency and damping with the first input, and the poles; as the core reads
    /// them.
    pub(crate) fn reading(&self, integrators: usize) -> Reading {
        let behind = self.poles(integrators);
        let lowest = self.a.get(integrators).copied().unwrap_or(1.0);
        let mut pair = None;
        if let [a0, a1] = self.a[integrators..] {
            if a0 > 0.0 {
                pair = Some((a0.sqrt(), 0.5 * a1 / a0.sqrt()));
            }
        } else if let Some((re, im)) = behind.iter().flatten().find(|(_, im)| *im != 0.0) {
            let omega0 = re.hypot(*im);
            pair = Some((omega0, -re / omega0));
        }
        let real = behind
            .iter()
            .flatten()
            .filter(|(re, im)| *im == 0.0 && *re < 0.0);
        Reading {
            gain: Some(self.b[0][0] / lowest).filter(|gain| gain.is_finite()),
            omega0: pair.map(|(omega0, _)| omega0),
            damping: pair.map(|(_, damping)| damping),
            time_constants: real.map(|(re, _)| -1.0 / re).collect(),
            stable: self.is_stable(integrators),
            poles: behind.map(|behind| {
                let mut poles = vec![(0.0, 0.0); integrators];
                poles.extend(behind);
                poles
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_and_polynomials_are_inverse() {
        // (s + 3) (s^2 + 4 s + 2504)
        let wanted = [7512.0, 2516.0, 7.0];
        let found = roots(&wanted).expect("roots");
        assert!((found[0].0 + 3.0).abs() < 1e-9 && found[0].1 == 0.0);
        assert!((found[1].0 + 2.0).abs() < 1e-9 && (found[1].1 + 50.0).abs() < 1e-9);
        for (found, wanted) in from_roots(&found).iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() < 1e-12);
        }
        assert_eq!(roots(&[]), Some(Vec::new()));
        assert_eq!(roots(&[f64::NAN, 1.0]), None);
    }

    #[test]
    fn the_reading_is_that_of_the_core() {
        let model = Polynomials {
            a: vec![0.0, 400.0, 20.0],
            b: vec![vec![1e6]],
            constant: 0.0,
        };
        let reading = model.reading(1);
        assert_eq!(
            (reading.gain, reading.omega0, reading.damping),
            (Some(2500.0), Some(20.0), Some(0.5))
        );
        assert!(reading.stable && reading.poles.expect("poles")[0] == (0.0, 0.0));
    }
}
