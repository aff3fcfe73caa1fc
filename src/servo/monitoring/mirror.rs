//! Whether the measured motion is the expected one with the other sign.

use crate::servo::monitoring::bounds::Bounds;

/// Slopes of the measured velocity over the expected one, as they change within 1.3/w and within 1/(3 w).
///
/// With a wrong sign the measured velocity changes when the expected one does, by as much, the other way: both slopes are about -1.
/// A spool that is stuck gives a velocity of its own, which does not change with the expected one. A load that falls without air moves first,
/// and what is commanded against it makes no difference: while the expectation grows the axis does not follow, and the slope of the shorter time
/// tells it. Half of the gain is enough for either.
///
/// The slopes are those of linear regressions with leaky means. Cost: about 35 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Mirror {
    slopes: [Slope; 2],
}

/// Slope below which the sign is wrong.
const MIRRORED: f32 = -0.4;

impl Mirror {
    /// One sample with the expected and the measured velocity.
    #[inline]
    pub(crate) fn update(&mut self, expected: f32, measured: f32, bounds: &Bounds) {
        for (slope, share) in self.slopes.iter_mut().zip(bounds.mirror) {
            slope.update(expected, measured, share);
        }
    }

    /// Whether the motion is mirrored.
    pub(crate) fn is_mirrored(&self) -> bool {
        self.slopes.iter().all(Slope::is_mirrored)
    }
}

/// Leaky means of two velocities, of the square of the first one, and of their product.
#[derive(Debug, Clone, PartialEq, Default)]
struct Slope {
    mean: [f32; 2],
    square: f32,
    product: f32,
}

impl Slope {
    #[inline]
    fn update(&mut self, expected: f32, measured: f32, share: f32) {
        self.mean[0] += share * (expected - self.mean[0]);
        self.mean[1] += share * (measured - self.mean[1]);
        self.square += share * (expected * expected - self.square);
        self.product += share * (expected * measured - self.product);
    }

    fn is_mirrored(&self) -> bool {
        let [e, m] = self.mean;
        self.product - e * m < MIRRORED * (self.square - e * e)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;

    #[test]
    fn only_what_changes_with_the_expectation_the_other_way_is_mirrored() {
        let model = Model::linear(400.0, 20.0, 4e5);
        let bounds = example::bounds(&model);
        let mirrored = |measured: fn(f32) -> f32| {
            let mut mirror = Mirror::default();
            // A flow that grows.
            for k in 0..100 {
                let t = 0.001 * k as f32;
                mirror.update(20_000.0 * t * t, measured(t), &bounds);
            }
            mirror.is_mirrored()
        };
        assert!(mirrored(|t| -20_000.0 * t * t), "a wrong sign");
        assert!(mirrored(|t| -12_000.0 * t * t), "one of a weaker drive");
        assert!(!mirrored(|_| -150.0), "a spool that is stuck");
        assert!(!mirrored(|t| 20_000.0 * t * t), "a sound axis");
        // First, with an acceleration that fades, and without regard to what is commanded.
        assert!(!mirrored(|t| -200.0 * t / (t + 0.01)), "a load that falls");
    }
}
