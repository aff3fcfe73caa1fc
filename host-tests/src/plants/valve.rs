//! Defects of a real drive: a valve with dead zone, offset and unequal gain, and Coulomb friction.

/// Static valve in front of a plant.
///
/// With `x = command + offset`: `flow = 0` for `|x| <= dead_zone`, else
/// `gain (x - sgn(x) dead_zone)`, then limited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticValve {
    /// Half width of the dead zone, in units of the command.
    pub dead_zone: f64,
    /// Offset added to the command.
    pub offset: f64,
    /// Gain for positive flow.
    pub gain_positive: f64,
    /// Gain for negative flow.
    pub gain_negative: f64,
    /// Largest magnitude of the flow.
    pub limit: f64,
}

impl StaticValve {
    /// A valve without defects.
    pub const IDEAL: Self = Self {
        dead_zone: 0.0,
        offset: 0.0,
        gain_positive: 1.0,
        gain_negative: 1.0,
        limit: f64::INFINITY,
    };

    /// Flow for a command.
    pub fn flow(&self, command: f64) -> f64 {
        let x = command + self.offset;
        let beyond = x.abs() - self.dead_zone;
        if beyond <= 0.0 {
            return 0.0;
        }
        let gain = if x > 0.0 {
            self.gain_positive
        } else {
            self.gain_negative
        };
        (gain * beyond * x.signum()).clamp(-self.limit, self.limit)
    }
}

/// Drive with Coulomb friction, `y'' + a y' = b u + d - c sgn(y')`, that sticks while
/// `|b u + d| <= c` at rest.
///
/// Exact for held inputs: every interval is cut at the zeros of the velocity, each piece is a
/// closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionDrive {
    /// Viscous damping over mass \[1/s\], positive.
    pub a: f64,
    /// Acceleration per unit command.
    pub b: f64,
    /// Coulomb friction over mass, positive.
    pub c: f64,
    /// Constant acceleration.
    pub d: f64,
    /// Acceleration beyond which it breaks away, at least `c`.
    pub breakaway: f64,
    y: f64,
    v: f64,
}

impl FrictionDrive {
    /// A drive at rest in the origin.
    ///
    /// # Panics
    /// When `a` or `c` is not positive.
    pub fn new(a: f64, b: f64, c: f64, d: f64) -> Self {
        assert!(
            a > 0.0 && c > 0.0,
            "damping {a} and friction {c} must be positive"
        );
        Self {
            a,
            b,
            c,
            d,
            breakaway: c,
            y: 0.0,
            v: 0.0,
        }
    }

    /// Position at the present instant.
    pub fn output(&self) -> f64 {
        self.y
    }

    /// Velocity at the present instant.
    pub fn velocity(&self) -> f64 {
        self.v
    }

    /// Holds `u` for `dt` seconds; returns the position at the end.
    pub fn step(&mut self, u: f64, dt: f64) -> f64 {
        let drive = self.b * u + self.d;
        let mut left = dt;
        // One interval holds at most: stop, start the other way. The third pass is the rest.
        for _ in 0..3 {
            let direction = if self.v != 0.0 {
                self.v.signum()
            } else if drive.abs() > self.breakaway {
                drive.signum()
            } else {
                return self.y;
            };
            let settled = (drive - direction * self.c) / self.a;
            // v(t) = settled + (v - settled) e^(-a t) reaches zero only when settled opposes it.
            let to_stop = if self.v != 0.0 && settled * direction < 0.0 {
                ((self.v - settled) / -settled).ln() / self.a
            } else {
                f64::INFINITY
            };
            let t = to_stop.min(left);
            let loss = -(-self.a * t).exp_m1();
            self.y += settled * t + (self.v - settled) * loss / self.a;
            self.v = if t < to_stop {
                self.v + (settled - self.v) * loss
            } else {
                0.0
            };
            left -= t;
            if left <= 0.0 {
                break;
            }
        }
        self.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valve_regions() {
        let valve = StaticValve {
            dead_zone: 0.03,
            offset: 0.01,
            gain_positive: 1.0,
            gain_negative: 0.8,
            limit: 0.5,
        };
        assert_eq!(valve.flow(0.0), 0.0);
        assert_eq!(valve.flow(0.0199), 0.0);
        assert!((valve.flow(0.12) - 0.10).abs() < 1e-15);
        assert!((valve.flow(-0.14) + 0.08).abs() < 1e-15);
        assert_eq!(valve.flow(9.0), 0.5);
        assert_eq!(StaticValve::IDEAL.flow(-0.3), -0.3);
    }

    #[test]
    fn friction_against_fine_steps() {
        // Semi-implicit Euler at 1 us as an independent reference.
        let (a, b, c, d) = (2.14, 0.37, 0.21, 0.033);
        let mut exact = FrictionDrive::new(a, b, c, d);
        let (mut y, mut v) = (0.0_f64, 0.0_f64);
        let h = 1e-6;
        let mut largest = 0.0_f64;
        for k in 0..2000 {
            let u = 1.5 * (f64::from(k) * 0.01).sin();
            exact.step(u, 1e-3);
            let drive = b * u + d;
            for _ in 0..1000 {
                let pushed = v + h * (drive - a * v);
                v = if pushed.abs() <= h * c {
                    0.0
                } else {
                    pushed - h * c * pushed.signum()
                };
                y += h * v;
            }
            largest = largest.max((exact.output() - y).abs());
        }
        assert!(y.abs() > 1e-3 || exact.velocity().abs() > 1e-3);
        assert!(largest < 2e-6, "largest difference {largest}");
    }

    #[test]
    fn sticks_at_rest() {
        let mut drive = FrictionDrive::new(1.0, 1.0, 0.5, 0.0);
        drive.step(0.49, 1.0);
        assert_eq!((drive.output(), drive.velocity()), (0.0, 0.0));
        drive.step(0.6, 1.0);
        assert!(drive.velocity() > 0.0);
        drive.step(0.0, 10.0);
        assert_eq!(drive.velocity(), 0.0);
    }
}
