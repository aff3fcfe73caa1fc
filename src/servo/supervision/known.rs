//! How well the verified model is known.

use crate::math;
use crate::servo::supervision::supervisor::Supervisor;

impl Supervisor {
    /// Standard deviations of a1, a2 and b0 of the verified model, as the recursion had them when
    /// it was submitted; infinite for a model of the commissioning or of the caller. Three square
    /// roots.
    pub fn verified_std(&self) -> [f32; 3] {
        self.variances.map(|variance| {
            // Nothing is known exactly: what has cancelled to zero, or is no number, is not known.
            if variance > 0.0 {
                math::sqrt(variance)
            } else {
                f32::INFINITY
            }
        })
    }

    /// What is known of the model that was installed last.
    pub(crate) fn recall(&mut self, std: [f32; 3]) {
        self.variances = std.map(|std| std * std);
    }
}

#[cfg(test)]
mod tests {
    use crate::servo::error::Error;
    use crate::servo::supervision::supervisor::tests::installed;

    #[test]
    fn deviations_are_those_that_were_recalled_and_nothing_is_known_exactly() -> Result<(), Error> {
        let mut supervisor = installed()?;
        assert_eq!(supervisor.verified_std(), [f32::INFINITY; 3]);
        supervisor.recall([2.0, 3.0, 5.0]);
        assert_eq!(supervisor.verified_std(), [2.0, 3.0, 5.0]);
        supervisor.recall([0.0, f32::NAN, f32::INFINITY]);
        assert_eq!(supervisor.verified_std(), [f32::INFINITY; 3]);
        Ok(())
    }
}
