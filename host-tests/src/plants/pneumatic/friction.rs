//! Stribeck friction that can stick.

/// Friction of seals and guide: `F = s (Fc + (Fb - Fc) exp(-(v/vs)^2)) + Fv v`, s the direction of
/// motion.
///
/// At rest any force up to the breakaway force is held. The direction is a discrete state of the
/// axis, not sgn(v), so that the axis truly rests and the force is smooth while it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Coulomb friction Fc \[N\].
    pub coulomb: f64,
    /// Breakaway force Fb \[N\].
    pub breakaway: f64,
    /// Viscous friction Fv \[N s/m\].
    pub viscous: f64,
    /// Velocity vs over which the breakaway force falls to the Coulomb friction \[m/s\].
    pub stribeck_velocity: f64,
}

impl Friction {
    /// Seals and guide of the servo axis.
    pub const SEALS: Self = Self {
        coulomb: 20.0,
        breakaway: 30.0,
        viscous: 60.0,
        stribeck_velocity: 0.03,
    };

    /// No friction at all.
    pub const NONE: Self = Self {
        coulomb: 0.0,
        breakaway: 0.0,
        viscous: 0.0,
        stribeck_velocity: 1.0,
    };

    /// All forces times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            coulomb: factor * self.coulomb,
            breakaway: factor * self.breakaway,
            viscous: factor * self.viscous,
            stribeck_velocity: self.stribeck_velocity,
        }
    }

    /// Friction force at a velocity while the axis moves in `direction` (+1 or -1) \[N\].
    pub fn force(&self, velocity: f64, direction: f64) -> f64 {
        let ratio = velocity / self.stribeck_velocity;
        // Beyond 6 vs the exponential is below the last bit of the sum.
        let square = ratio * ratio;
        let dip = if square < 36.0 {
            (self.breakaway - self.coulomb) * (-square).exp()
        } else {
            0.0
        };
        direction * (self.coulomb + dip) + self.viscous * velocity
    }

    /// Direction in which a resting axis starts under a force: 0 while it sticks.
    pub fn start(&self, force: f64) -> f64 {
        if force.abs() > self.breakaway {
            force.signum()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stribeck_curve() {
        let f = Friction::SEALS;
        assert_eq!(f.force(0.0, 1.0), f.breakaway);
        assert_eq!(f.force(0.0, -1.0), -f.breakaway);
        assert_eq!(f.force(1.0, 1.0), f.coulomb + f.viscous);
        // The minimum of the curve lies between rest and the viscous branch.
        assert!(f.force(0.06, 1.0) < f.breakaway);
        assert_eq!(f.start(f.breakaway), 0.0);
        assert_eq!(f.start(-f.breakaway - 1e-9), -1.0);
    }
}
