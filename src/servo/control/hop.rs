//! How far the axis hops when it breaks away, and whether a hop is worth it.

/// Shortest way that the axis makes between breaking away and sticking again.
///
/// What friction holds breaks away with more force than it slides with, and is noticed a little
/// later: so an axis hops by h at least. From an error e it lands at h - e, which is better exactly
/// when `h < 2 e`: below that it is left where it is. Behind a reference that goes farther than a
/// hop it will not stick there, and is brought along at once.
///
/// ```text
/// h <- h + share (way - h)      after a hop past the reference (0.5), and after any that was shorter (0.1)
/// ```
///
/// A hop that stops in front of the reference was as long as it should be and says nothing but that
/// h is no longer than it. If h is too long, the hops that are made are shorter, and h comes back;
/// if it is too short, they lead past the reference. The shares make h one of the longer hops: a
/// hop too many costs all of it, one too few at most half. Ways along a reference that goes far
/// itself are none, and one behind a pause of the reference is that of a quicker push. An axis that
/// goes on as before is nearer to its breakaway than one that turns, and hops less: each has its
/// length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Hop {
    /// Lengths on in the direction of the motion before, and against it.
    lengths: [f32; 2],
    /// Direction of the motion before.
    last: f32,
    /// Where the reference turned last, its velocity since, and how far it went before.
    turn: f32,
    velocity: f32,
    swing: f32,
}

/// Parts of a hop that count, of one past the reference and of a shorter one.
const SHARE: [f32; 2] = [0.5, 0.1];

impl Hop {
    /// The axis sticks again after a motion in a direction, that led from one error to another;
    /// `counts`: the reference went less far than the axis, and had not paused before.
    pub(crate) fn ended(&mut self, direction: f32, [before, after]: [f32; 2], counts: bool) {
        let length = &mut self.lengths[usize::from(direction * self.last < 0.0)];
        self.last = direction;
        let (way, least) = (direction * (before - after), direction * before);
        if !counts || before == 0.0 || !(way > 0.0) {
            return;
        }
        let [longer, shorter] = SHARE;
        if way < *length {
            *length += shorter * (way - *length);
        } else if way > least {
            *length += longer * (way - *length);
        }
    }

    /// Follows the reference.
    #[inline]
    pub(crate) fn follow(&mut self, position: f32, velocity: f32) {
        if velocity * self.velocity < 0.0 {
            self.swing = (position - self.turn).abs();
            self.turn = position;
        }
        if velocity != 0.0 {
            self.velocity = velocity;
        }
    }

    /// How far the reference swings: from one turn to the next, or since the last one.
    fn swing(&self, position: f32) -> f32 {
        let gone = (position - self.turn).abs();
        if gone > self.swing { gone } else { self.swing }
    }

    /// The hop in a direction; 0 before there was one.
    pub(crate) fn length(&self, direction: f32) -> f32 {
        self.lengths[usize::from(direction * self.last < 0.0)]
    }

    /// Least error that a hop in a direction makes smaller.
    pub(crate) fn worth(&self, direction: f32, position: f32) -> f32 {
        let length = self.length(direction);
        if self.swing(position) < length {
            0.5 * length
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis that hops by at least `least`, behind a sine of such an amplitude; the largest error
    /// in the last half.
    fn behind(least: f32, amplitude: f32) -> f32 {
        let (mut hop, mut position, mut worst) = (Hop::default(), 0.0_f32, 0.0_f32);
        for k in 0..4000 {
            let phase = 0.01 * k as f32;
            let reference = amplitude * libm::sinf(phase);
            hop.follow(reference, amplitude * libm::cosf(phase));
            let error = reference - position;
            let direction = if error > 0.0 { 1.0 } else { -1.0 };
            if error.abs() > hop.worth(direction, reference) && error.abs() > 1e-3 {
                let way = if error.abs() > least {
                    error.abs()
                } else {
                    least
                };
                position += direction * way;
                hop.ended(direction, [error, reference - position], true);
            }
            if k > 2000 {
                worst = worst.max((reference - position).abs());
            }
        }
        worst
    }

    #[test]
    fn an_axis_that_hops_farther_than_its_reference_stands_still() {
        // Hopping all the same, it would be off by nearly a hop.
        for least in [3.0, 10.0] {
            let worst = behind(least, 1.0);
            assert!(worst <= 0.5 * least + 1.0, "{least}: {worst}");
            assert!(worst < 0.9 * least, "{least}: {worst}");
        }
        // One that hops by less than it swings goes along.
        assert!(behind(0.2, 1.0) <= 0.2);
    }

    #[test]
    fn hops_past_the_reference_and_shorter_ones_count_by_their_direction() {
        let mut hop = Hop::default();
        hop.ended(1.0, [1.0, -3.0], true);
        assert_eq!(hop.lengths, [2.0, 0.0]);
        // Back: against the motion before.
        hop.ended(-1.0, [-3.0, 1.0], true);
        assert_eq!(hop.lengths, [2.0, 2.0]);
        // A shorter one counts little, whether it stopped in front of the reference or not.
        hop.ended(-1.0, [-3.0, -2.0], true);
        assert!((hop.lengths[0] - 1.9).abs() < 1e-6);
        // A longer one that stopped in front of it says nothing, nor does one along a reference
        // that moved as far, nor one that led away.
        let before = hop;
        hop.ended(-1.0, [-9.0, -1.0], true);
        hop.ended(-1.0, [-3.0, 6.0], false);
        hop.ended(-1.0, [-3.0, -4.0], true);
        hop.ended(-1.0, [0.0, 5.0], true);
        assert_eq!(hop, before);
        hop.ended(1.0, [-3.0, 6.0], false);
        assert_eq!(hop.last, 1.0, "the direction is known all the same");
    }

    #[test]
    fn a_hop_is_worth_it_from_half_of_its_length_on() {
        let mut hop = Hop::default();
        assert_eq!(hop.worth(1.0, 0.0), 0.0);
        hop.ended(1.0, [1.0, -7.0], true);
        assert_eq!(hop.worth(1.0, 0.0), 2.0);
        assert_eq!(hop.worth(-1.0, 0.0), 0.0, "nothing is known of that way");
        // The reference goes 3.9, turns, and 4.1 back.
        hop.follow(0.0, 1.0);
        hop.follow(3.9, 1.0);
        assert_eq!(hop.worth(1.0, 3.9), 2.0);
        hop.follow(3.9, -1.0);
        assert_eq!(hop.worth(1.0, 3.0), 2.0);
        assert_eq!(hop.worth(1.0, -0.2), 0.0);

        // A pause is no turn.
        let mut paused = hop;
        for (position, velocity) in [(-3.0, -1.0), (-3.0, 0.0), (-6.0, -1.0)] {
            paused.follow(position, velocity);
        }
        assert_eq!((paused.turn, paused.swing), (hop.turn, hop.swing));
    }
}
