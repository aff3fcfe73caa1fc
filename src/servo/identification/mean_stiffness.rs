//! The stiffness that an identifier has seen.

use crate::servo::design::IdentificationDesign;

/// Stiffness of the axis over that in the middle, where an identifier has learnt.
///
/// The identifier knows one drive, a1 and b0 of where the axis moves; a model is of the middle. Of
/// a drive whose a1 is k times that of the middle, k by the place, least squares find a1 times
///
/// ```text
/// mean = Sum lambda^n v^2 k / Sum lambda^n v^2
/// ```
///
/// since a sample weighs with the square of what a1 multiplies, the velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeanStiffness {
    /// Where the identifier began: the mean before it has learnt.
    first: f32,
    /// Both sums.
    stiffness: f32,
    weight: f32,
    /// lambda.
    kept: f32,
}

impl MeanStiffness {
    /// Of an axis in the middle.
    pub(crate) fn new(design: &IdentificationDesign, sample_time: f32) -> Self {
        Self {
            first: 1.0,
            stiffness: 0.0,
            weight: 0.0,
            kept: 1.0 - sample_time / design.memory,
        }
    }

    /// The identifier begins at this stiffness.
    pub(crate) const fn begin(&mut self, stiffness: f32) {
        (self.first, self.stiffness, self.weight) = (stiffness, 0.0, 0.0);
    }

    /// A sample that the identifier learns from. Cost: about 15 instructions.
    #[inline]
    pub(crate) fn add(&mut self, stiffness: f32, velocity: f32) {
        let square = velocity * velocity;
        let sum = self.kept * self.stiffness + square * stiffness;
        if sum < f32::INFINITY {
            self.stiffness = sum;
            self.weight = self.kept * self.weight + square;
        }
    }

    /// The mean; a1 and b0 of the identifier over those in the middle.
    pub(crate) fn mean(&self) -> f32 {
        if self.weight > f32::MIN_POSITIVE {
            self.stiffness / self.weight
        } else {
            self.first
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::config::Config;
    use crate::servo::error::Error;
    use crate::servo::motion::Travel;

    fn mean_stiffness() -> Result<(MeanStiffness, f32), Error> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let design = Config::new(1e-3, 30.0, travel).resolve()?;
        let memory = design.identification.memory;
        Ok((MeanStiffness::new(&design.identification, 1e-3), memory))
    }

    #[test]
    fn the_mean_is_what_least_squares_find_of_a_stiffness_that_changes() -> Result<(), Error> {
        let (mut mean, memory) = mean_stiffness()?;
        mean.begin(1.0);
        let kept = 1.0 - 1e-3 / memory;
        // a1 of z = a1 k v, with the squares forgotten.
        let (a1, mut products, mut squares) = (900.0_f32, 0.0_f32, 0.0_f32);
        for k in 0..20_000 {
            let phase = 2e-3 * k as f32;
            let (v, stiffness) = (
                200.0 * libm::cosf(phase),
                1.6 + 0.6 * libm::sinf(phase) * libm::sinf(phase),
            );
            mean.add(stiffness, v);
            products = kept * products + v * (a1 * stiffness * v);
            squares = kept * squares + v * v;
            let exact = products / squares / a1;
            assert!((mean.mean() / exact - 1.0).abs() < 1e-3, "{k}");
        }
        Ok(())
    }

    #[test]
    fn an_axis_at_rest_and_numbers_that_are_none_leave_it_as_it_is() -> Result<(), Error> {
        let (mut mean, _) = mean_stiffness()?;
        mean.begin(1.5);
        mean.add(3.0, 0.0);
        assert_eq!(mean.mean(), 1.5);
        mean.add(2.0, 100.0);
        assert_eq!(mean.mean(), 2.0);
        for velocity in [f32::NAN, f32::INFINITY, 1e30, 0.0] {
            mean.add(3.0, velocity);
            assert_eq!(mean.mean(), 2.0, "{velocity}");
        }
        mean.begin(1.0);
        assert_eq!(mean.mean(), 1.0);
        Ok(())
    }
}
