//! Coulomb friction: the sign of the velocity, and where between two samples it changes.

/// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero.
///
/// # Examples
/// ```
/// assert_eq!(trendid::inputs::coulomb(-0.4, 0.01), -1.0);
/// assert_eq!(trendid::inputs::coulomb(0.001, 0.01), 0.0);
/// ```
#[inline]
pub fn coulomb(velocity: f32, rest: f32) -> f32 {
    if velocity > rest {
        1.0
    } else if velocity < -rest {
        -1.0
    } else {
        0.0
    }
}

/// A deceleration that changed by more than this share from one interval to the next was that of
/// another command.
const STEADY: f32 = 0.2;

/// The input of Coulomb friction on a drive that turns between two samples: the mean sign of the
/// velocity since the sample before, for an input with [`Hold::Mean`](crate::trends::Hold::Mean).
///
/// Where between the samples a drive turned follows from its velocities before: until then it
/// slowed down as before,
///
/// ```text
/// d_1  = v(k-2) - v(k-1),   g = d_1 - (v(k-3) - v(k-2))       g is left out where it exceeds a fifth of d_1
/// tau  = v(k-1) / (d_1 + g (1 + tau) / 2)                      by the time in the middle of both intervals
/// mean = (2 tau - 1) sgn v(k-1)                                tau within 0..1
/// ```
///
/// or, where it did not slow down, on a straight line from v(k-1) to v(k). The sign at the samples
/// misplaces each turn by up to half a sample time, which no noise level contains: the trends keep
/// it for the memory of their filter. With g it is 1e-4 of a sample time on a drive of 20 rad/s at
/// 1 kHz, without it 7e-3.
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | v | `velocity` | any |
/// | - | `rest`: slower is 0 | that of v |
///
/// # Examples
/// ```
/// let mut friction = trendid::inputs::Coulomb::new(0.01);
/// assert_eq!(friction.update(-7.0), -1.0);
/// assert_eq!(friction.update(-3.0), -1.0);
/// assert_eq!(friction.update(1.0), -0.5); // it turned after three quarters of the time
/// assert_eq!(friction.update(0.0), 1.0);
/// assert_eq!(friction.update(0.0), 0.0); // it stands
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Coulomb {
    rest: f32,
    /// v(k-1), v(k-2), v(k-3).
    past: [f32; 3],
}

impl Coulomb {
    /// A drive at rest; velocities within `rest` of zero are zero, NaN included.
    pub const fn new(rest: f32) -> Self {
        Self {
            rest,
            past: [0.0; 3],
        }
    }

    /// Takes v(k). Cost: 25 instructions.
    #[inline]
    pub fn update(&mut self, velocity: f32) -> f32 {
        let now = match coulomb(velocity, self.rest) {
            0.0 => 0.0,
            _ => velocity,
        };
        let [before, second, third] = self.past;
        self.past = [now, before, second];
        let (old, new) = (coulomb(before, 0.0), coulomb(now, 0.0));
        if old * new >= 0.0 {
            return if new == 0.0 { old } else { new };
        }
        let slowed = second - before;
        // The same sign as before, and slower: it goes on like that.
        let slows = slowed * before > 0.0 && slowed.abs() >= before.abs();
        let tau = if slows {
            let tau = before / slowed;
            let change = slowed - (third - second);
            match change.abs() <= STEADY * slowed.abs() {
                true => before / (slowed + 0.5 * change * (1.0 + tau)),
                false => tau,
            }
        } else {
            before / (before - now)
        };
        let tau = match tau > 0.0 {
            true if tau > 1.0 => 1.0,
            true => tau,
            false => 0.5,
        };
        old * (2.0 * tau - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_at_the_edges() {
        assert_eq!(coulomb(0.01, 0.01), 0.0);
        assert_eq!(coulomb(f32::NAN, 0.01), 0.0);
        let mut friction = Coulomb::new(0.0);
        for v in [
            1.0,
            f32::NAN,
            -1.0,
            f32::MAX,
            f32::MIN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            1e-45,
        ] {
            assert!(friction.update(v).abs() <= 1.0, "{v}");
        }
    }

    /// Viscous damping changes the deceleration by 2 % a sample; the turn is found as if it were
    /// known.
    #[test]
    fn a_turn_under_viscous_damping_is_found() {
        for part in 1..10 {
            // v = s + (v_0 - s) e^(-0.02 t), zero at 0.1 part of the sample time behind t = 3;
            // other friction behind it.
            let turn = 3.0 + 0.1 * part as f32;
            let v = |t: f32| -350.0 * (1.0 - (-0.02 * (t - turn)).exp());
            let mut friction = Coulomb::new(0.01);
            for k in 0..4 {
                assert_eq!(friction.update(v(k as f32)), 1.0);
            }
            let mean = friction.update(1.2 * v(4.0));
            let exact = 2.0 * (turn - 3.0) - 1.0;
            assert!((mean - exact).abs() < 1e-3, "{mean} for {exact}");
        }
    }

    /// Means of the sign along some velocities.
    fn means<const K: usize>(velocities: [f32; K]) -> [f32; K] {
        let mut friction = Coulomb::new(0.01);
        velocities.map(|v| friction.update(v))
    }

    #[test]
    fn a_turn_is_found_in_both_directions() {
        for sign in [1.0, -1.0] {
            let of = |velocities: [f32; 4]| means(velocities.map(|v| sign * v)).map(|m| sign * m);
            // As slow as before: three quarters of the interval, whatever comes after.
            assert_eq!(of([11.0, 7.0, 3.0, -1.0]), [1.0, 1.0, 1.0, 0.5]);
            assert_eq!(of([11.0, 7.0, 3.0, -9.0])[3], 0.5);
            // Too slow to turn within it, or quicker than before: on a straight line.
            assert_eq!(of([5.0, 4.0, 3.0, -1.0])[3], 0.5);
            assert_eq!(of([1.0, 2.0, 3.0, -3.0])[3], 0.0);
            // What changed by more than a fifth was another command: the last interval alone.
            assert_eq!(of([7.0, 7.0, 3.0, -9.0])[3], 0.5);
            // Slowing down less and less it would not have turned within the interval.
            assert_eq!(of([9.8, 6.1, 3.0, -1.0])[3], 1.0);
            // It turned and stands, and it starts from rest.
            assert_eq!(of([2.0, 1.0, 0.0, 0.0]), [1.0, 1.0, 1.0, 0.0]);
            assert_eq!(of([2.0, 1.0, 0.005, 0.005]), [1.0, 1.0, 1.0, 0.0]);
            assert_eq!(of([0.0, 0.0, 0.5, 0.5]), [0.0, 0.0, 1.0, 1.0]);
        }
    }

    #[test]
    fn a_deceleration_that_grows_is_carried_on() {
        // Quadratic: v = 10 - t - t^2/2 is zero at 1.58 behind t = 2, that is 0.583 behind t = 3.
        let v = |t: f32| 10.0 - t - 0.5 * t * t;
        let mut friction = Coulomb::new(1e-3);
        let exact = libm::sqrtf(21.0) - 1.0;
        for k in 0..4 {
            assert_eq!(friction.update(v(k as f32)), 1.0);
        }
        let mean = friction.update(-50.0);
        let tau = 0.5 * (mean + 1.0);
        // The change is a quarter of the deceleration there, and left out.
        assert!((tau - 2.5 / 3.5).abs() < 1e-6, "{tau}");
        assert!((exact - 3.58).abs() < 0.01);
        // At a tenth of that it counts.
        let v = |t: f32| 10.0 - 2.8 * t - 0.05 * t * t;
        let mut friction = Coulomb::new(1e-3);
        for k in 0..4 {
            assert_eq!(friction.update(v(k as f32)), 1.0);
        }
        let tau = 0.5 * (friction.update(-50.0) + 1.0);
        let exact = (libm::sqrtf(2.8 * 2.8 + 2.0) - 2.8) / 0.1 - 3.0;
        assert!((tau - exact).abs() < 1e-3, "{tau} {exact}");
    }
}
