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

/// A flow, and the stiffness of the axis where it acts over that in the middle, which models are
/// of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedFlow {
    pub(crate) flow: f32,
    pub(crate) stiffness: f32,
}

impl PlacedFlow {
    /// A flow of an axis that is as stiff as in the middle.
    pub(crate) const fn in_the_middle(flow: f32) -> Self {
        Self {
            flow,
            stiffness: 1.0,
        }
    }

    /// What moves a drive of the middle like the one at this place.
    #[inline]
    pub(crate) const fn moved(&self) -> MovedFlow {
        MovedFlow {
            flow: self.stiffness * self.flow,
            slope: self.stiffness - 1.0,
        }
    }
}

/// The flow under which a drive as it is in the middle goes on like one that is k times as stiff.
///
/// ```text
/// x''' + a2 x'' = k (b0 flow - a1 x') = b0 moved - a1 x',   moved = k flow - (k - 1) x'/C
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MovedFlow {
    flow: f32,
    /// k - 1.
    slope: f32,
}

impl MovedFlow {
    /// At a velocity of a drive with this 1/C.
    #[inline]
    pub(crate) fn at(&self, velocity: f32, inverse_gain: f32) -> f32 {
        self.flow - self.slope * (velocity * inverse_gain)
    }
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
    use crate::servo::model::Model;
    use crate::servo::motion::Motion;

    #[test]
    fn a_drive_of_the_middle_goes_on_like_the_stiffer_one_under_the_moved_flow() {
        let middle = Model::linear(900.0, 15.0, 9e5);
        for stiffness in [1.0_f32, 1.4, 2.2, 3.0] {
            let (a1, b0) = (stiffness * middle.a1, stiffness * middle.b0);
            let there = Model { a1, b0, ..middle };
            let (mut own, mut like) = (Motion::default(), Motion::default());
            let mut apart = 0.0_f32;
            for k in 0..2000 {
                let flow = if (k / 150) % 2 == 0 { 0.3 } else { -0.2 };
                let at = PlacedFlow { flow, stiffness };
                there.advance(&mut own, flow, 1e-3);
                let moved = at.moved().at(like.velocity, middle.a1 / middle.b0);
                middle.advance(&mut like, moved, 1e-3);
                apart = apart.max((own.velocity - like.velocity).abs());
            }
            // Of some 300: the velocity is held for a sample.
            assert!(
                apart < 15.0 * (stiffness - 1.0) + 1e-3,
                "{stiffness}: {apart}"
            );
        }
    }

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
