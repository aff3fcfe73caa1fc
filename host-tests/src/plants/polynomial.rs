//! Polynomials in the back shift `q^-1`, coefficients in ascending powers, and difference
//! equations.

/// Product of two polynomials.
pub fn product(p: &[f64], r: &[f64]) -> Vec<f64> {
    if p.is_empty() || r.is_empty() {
        return Vec::new();
    }
    let mut out = vec![0.0; p.len() + r.len() - 1];
    for (i, a) in p.iter().enumerate() {
        for (j, b) in r.iter().enumerate() {
            out[i + j] += a * b;
        }
    }
    out
}

/// `p^n`.
pub fn power(p: &[f64], n: usize) -> Vec<f64> {
    (0..n).fold(vec![1.0], |out, _| product(&out, p))
}

/// `p` times `factor`.
pub fn scaled(p: &[f64], factor: f64) -> Vec<f64> {
    p.iter().map(|c| c * factor).collect()
}

/// Sum of two polynomials.
pub fn sum(p: &[f64], r: &[f64]) -> Vec<f64> {
    let at = |x: &[f64], i: usize| x.get(i).copied().unwrap_or(0.0);
    (0..p.len().max(r.len()))
        .map(|i| at(p, i) + at(r, i))
        .collect()
}

/// `q^-n p`.
pub fn delayed(p: &[f64], n: usize) -> Vec<f64> {
    let mut out = vec![0.0; n];
    out.extend_from_slice(p);
    out
}

/// Coefficients `f[0]..f[m]`, ascending and with `f[m] = 1`, of `(s + poles[0]) (s + poles[1]) ..`.
pub fn monic(poles: &[f64]) -> Vec<f64> {
    poles
        .iter()
        .fold(vec![1.0], |p, pole| product(&p, &[*pole, 1.0]))
}

/// `numerator(q^-1) x(k)` with `x = 0` before the record.
pub fn moving_sum(numerator: &[f64], x: &[f64]) -> Vec<f64> {
    (0..x.len())
        .map(|k| {
            numerator
                .iter()
                .take(k + 1)
                .enumerate()
                .map(|(i, c)| c * x[k - i])
                .sum()
        })
        .collect()
}

/// `y` with `denominator(q^-1) y = numerator(q^-1) x`, from rest.
///
/// # Panics
/// When the denominator is empty or its first coefficient is zero.
pub fn difference_equation(numerator: &[f64], denominator: &[f64], x: &[f64]) -> Vec<f64> {
    assert!(
        denominator.first().is_some_and(|d| *d != 0.0),
        "the denominator must start with a nonzero coefficient"
    );
    let mut y: Vec<f64> = Vec::with_capacity(x.len());
    for (k, forced) in moving_sum(numerator, x).into_iter().enumerate() {
        let past: f64 = denominator[1..]
            .iter()
            .take(k)
            .enumerate()
            .map(|(i, c)| c * y[k - 1 - i])
            .sum();
        y.push((forced - past) / denominator[0]);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic() {
        assert_eq!(product(&[1.0, -1.0], &[1.0, 1.0]), [1.0, 0.0, -1.0]);
        assert_eq!(power(&[1.0, -1.0], 3), [1.0, -3.0, 3.0, -1.0]);
        assert_eq!(sum(&[1.0], &[2.0, 3.0]), [3.0, 3.0]);
        assert_eq!(delayed(&[1.0], 2), [0.0, 0.0, 1.0]);
        assert_eq!(monic(&[20.0, 20.0, 20.0]), [8000.0, 1200.0, 60.0, 1.0]);
    }

    #[test]
    fn difference_equation_of_a_lag() {
        let y = difference_equation(&[0.5], &[2.0, -1.0], &[1.0, 0.0, 0.0]);
        assert_eq!(y, [0.25, 0.125, 0.0625]);
        assert_eq!(moving_sum(&[1.0, 2.0], &[1.0, 0.0, 3.0]), [1.0, 2.0, 3.0]);
    }
}
