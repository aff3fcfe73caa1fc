//! The reference servo of the paper's Table 2 and its physical reading.

use crate::plants::linear::LinearPlant;

/// Position servo `x/u = C w0^2 / (s (s^2 + 2 xi w0 s + w0^2)) = b0 / (s (s^2 + a2 s + a1))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// Velocity gain `C` \[mm/s per unit command\].
    pub c: f64,
    /// Natural frequency `w0` \[rad/s\].
    pub omega0: f64,
    /// Damping `xi` \[1\].
    pub xi: f64,
}

/// The plant of the paper's Table 2: `a2 = 20`, `a1 = 400`, `b0 = 1e6`.
pub const REFERENCE: Servo = Servo {
    c: 2500.0,
    omega0: 20.0,
    xi: 0.5,
};

impl Servo {
    /// Denominator `[0, a1, a2]`, ascending: `a1 = w0^2`, `a2 = 2 xi w0`.
    pub fn a(&self) -> [f64; 3] {
        [0.0, self.omega0 * self.omega0, 2.0 * self.xi * self.omega0]
    }

    /// Numerator `b0 = C w0^2`.
    pub fn b0(&self) -> f64 {
        self.c * self.omega0 * self.omega0
    }

    /// Physical reading of `(a1, a2, b0)`, or nothing when `a1` is not positive and finite.
    pub fn from_coefficients(a1: f64, a2: f64, b0: f64) -> Option<Self> {
        if !(a1 > 0.0 && a1.is_finite() && a2.is_finite() && b0.is_finite()) {
            return None;
        }
        let omega0 = a1.sqrt();
        Some(Self {
            c: b0 / a1,
            omega0,
            xi: a2 / (2.0 * omega0),
        })
    }

    /// The plant at rest, sampled every `dt` seconds.
    ///
    /// # Panics
    /// When a parameter is not finite or `dt` is not positive.
    pub fn plant(&self, dt: f64) -> LinearPlant {
        match LinearPlant::new(&self.a(), &[self.b0()], dt) {
            Ok(plant) => plant,
            Err(error) => panic!("servo {self:?}: {error}"),
        }
    }

    /// Errors as of [`error_pct`](Self::error_pct) of what (a1, a2, b0, ..) read as; infinite
    /// where there is no reading.
    pub fn errors_of(theta: &[f32], truth: &Self) -> [f64; 3] {
        let [a1, a2, b0] = [theta[0], theta[1], theta[2]].map(f64::from);
        Self::from_coefficients(a1, a2, b0)
            .map_or([f64::INFINITY; 3], |found| found.error_pct(truth))
    }

    /// Relative errors of `C`, `w0`, `xi` against `truth` \[%\], signed.
    pub fn error_pct(&self, truth: &Self) -> [f64; 3] {
        [
            100.0 * (self.c / truth.c - 1.0),
            100.0 * (self.omega0 / truth.omega0 - 1.0),
            100.0 * (self.xi / truth.xi - 1.0),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_and_coefficients_are_inverse() {
        assert_eq!(REFERENCE.a(), [0.0, 400.0, 20.0]);
        assert_eq!(REFERENCE.b0(), 1e6);
        assert_eq!(Servo::from_coefficients(400.0, 20.0, 1e6), Some(REFERENCE));
        assert_eq!(Servo::from_coefficients(-1.0, 20.0, 1e6), None);
        assert_eq!(Servo::from_coefficients(f64::NAN, 20.0, 1e6), None);
    }

    #[test]
    fn errors_are_signed_percent() {
        let off = Servo {
            c: 2525.0,
            omega0: 19.0,
            xi: 0.5,
        };
        let e = off.error_pct(&REFERENCE);
        assert!((e[0] - 1.0).abs() < 1e-9 && (e[1] + 5.0).abs() < 1e-9 && e[2] == 0.0);
    }
}
