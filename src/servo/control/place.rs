//! What the place on the travel does to the stiffness of an axis.

use crate::math::sqrt;
use crate::servo::motion::Travel;

/// e of a dead volume.
pub(crate) fn stiffening(dead_volume: f32) -> f32 {
    let half = dead_volume + 0.5;
    1.0 / (half * half)
}

/// The dead volume of an e.
pub(crate) fn dead_volume(stiffening: f32) -> f32 {
    if stiffening > 0.0 {
        1.0 / sqrt(stiffening) - 0.5
    } else {
        f32::INFINITY
    }
}

/// Square of the distance of a `share` of the travel from the middle, at most that of an end.
#[inline]
pub(crate) fn off_middle(share: f32) -> f32 {
    let half = share - 0.5;
    let square = half * half;
    if square < 0.25 { square } else { 0.25 }
}

/// Stiffness at `share` of the travel over that in the middle; e is less than 4.
#[inline]
pub(crate) fn stiffness(stiffening: f32, share: f32) -> f32 {
    1.0 / (1.0 - stiffening * off_middle(share))
}

/// Stiffness of a cylinder over that in the middle of its travel.
///
/// ```text
/// k(x) = (1/(d + q) + 1/(d + 1 - q)) (d + 1/2)/2 = 1/(1 - e (q - 1/2)^2),   q = (x - min)/L,   e = 1/(d + 1/2)^2
/// ```
///
/// Each chamber is a spring as stiff as it is short; d is its dead volume over that of the stroke.
/// The velocity gain C does not depend on the place, so that a1 and b0 both grow with k. An
/// infinite d, an e of 0, is a drive of the same stiffness everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    min: f32,
    inverse_length: f32,
    /// e.
    stiffening: f32,
    /// Stiffness, and its square root followed by Newton's method.
    stiffness: f32,
    root: f32,
}

impl Place {
    pub(crate) fn new(travel: Travel, dead_volume: f32) -> Self {
        Self {
            min: travel.min,
            inverse_length: 1.0 / travel.length(),
            stiffening: stiffening(dead_volume),
            stiffness: 1.0,
            root: 1.0,
        }
    }

    /// Goes to a position. Cost: about 35 instructions, two of them divisions.
    #[inline]
    pub(crate) fn go(&mut self, position: f32) {
        let share = (position - self.min) * self.inverse_length;
        self.stiffness = stiffness(self.stiffening, share);
        self.root = 0.5 * (self.root + self.stiffness / self.root);
    }

    /// Goes to a position that may be far away. Cost: one square root more.
    pub(crate) fn jump(&mut self, position: f32) {
        self.go(position);
        self.root = sqrt(self.stiffness);
    }

    /// Stiffness over that in the middle.
    #[inline]
    pub(crate) const fn stiffness(&self) -> f32 {
        self.stiffness
    }

    /// Its square root: the natural frequency over that in the middle.
    #[inline]
    pub(crate) const fn frequency(&self) -> f32 {
        self.root
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_one_and_the_ends_are_stiffer() {
        let travel = Travel {
            min: -100.0,
            max: 300.0,
        };
        let mut place = Place::new(travel, 0.06);
        for x in [100.0, 100.0, 100.0] {
            place.go(x);
        }
        assert!((place.stiffness() - 1.0).abs() < 1e-6);
        place.jump(-60.0);
        assert!((place.stiffness() - 2.0416).abs() < 1e-3);
        assert!((place.frequency() * place.frequency() - place.stiffness()).abs() < 1e-5);
        let mut even = Place::new(travel, f32::INFINITY);
        even.go(-100.0);
        assert!((even.stiffness() - 1.0).abs() < 1e-6);
    }
}
