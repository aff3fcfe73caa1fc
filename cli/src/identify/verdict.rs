//! What a model is worth, in one line, and what speaks against it.

use trendid_identify::{Friction, Way};

use super::report::Report;
use crate::format::significant;

/// Below this fit in percent a model says little about the drive.
const POOR: f64 = 50.0;

/// From this fit on it says most.
const GOOD: f64 = 80.0;

/// Error of a simulation over that with the constant refitted, from which on an offset shows.
const OFFSET: f64 = 1.25;

impl Report<'_> {
    /// One line on what the model is worth, by both fits.
    pub(crate) fn verdict(&self) -> String {
        let [x0, x0c] = self.fits();
        // A model fits as well with parameters that make up for a delay, which +- does not contain.
        let found = self.found;
        let off = found.poor_input.is_some()
            || found.delay_missed().is_some()
            || found.delay_untold()
            || found.delay_imitated.is_some();
        let worth = if !self.found.estimate.reading.stable {
            "unstable"
        } else if !(x0c >= POOR) {
            "poor"
        } else if x0 >= GOOD && x0c >= GOOD && !off {
            "good"
        } else if x0 < POOR {
            "doubtful: it fits with the constant refitted only"
        } else {
            "fair"
        };
        let mut verdict = worth.to_owned();
        let insignificant = self.insignificant();
        if !insignificant.is_empty() {
            verdict += &format!("; not significant: {}", insignificant.join(", "));
        }
        let still = self.standstill_s();
        if still > 0.0 {
            verdict += &format!("; standstill removed: {} s", significant(still, 3));
        }
        if let Some(poor) = self.found.poor_input {
            verdict += &format!("; doubtful: delay and parameters rest on {}", poor.name());
        }
        if let Some(longer) = self.found.delay_imitated {
            verdict += &format!(
                "; doubtful: a delay of about {} samples simulates as well in the place of the zero in the right half plane (+- contains it)",
                significant(longer, 3)
            );
        }
        if let Some([missed, sigma]) = self.found.delay_missed() {
            verdict += &format!(
                "; the record shows a delay of about {} samples, not {} ({} standard deviations)",
                significant(self.found.delay + missed, 2),
                significant(self.found.delay, 3),
                significant((missed / sigma).abs(), 2)
            );
        }
        if self.found.delay_untold() {
            verdict += "; doubtful: the record does not tell the delay";
        }
        if let Some(far) = self.found.filter_dependence() {
            verdict += &format!(
                "; {} depends on the filter ({} standard deviations; +- contains it)",
                self.first(),
                significant(far, 2)
            );
        }
        verdict
    }

    /// Whether a constant takes much of what a model without one leaves.
    fn offset(&self) -> bool {
        let [x0, x0c] = self.fits();
        !self.problem.structure.constant && 100.0 - x0 > OFFSET * (100.0 - x0c)
    }

    fn first(&self) -> String {
        let names = self.problem.parameter_names();
        names.into_iter().next().unwrap_or_default()
    }

    /// Parameters within two standard deviations of zero.
    fn insignificant(&self) -> Vec<String> {
        let e = &self.found.estimate;
        let names = self.problem.parameter_names().into_iter();
        let insignificant = |(j, _): &(usize, String)| e.theta[*j].abs() < 2.0 * e.sigma[*j];
        names
            .enumerate()
            .filter(insignificant)
            .map(|(_, name)| name)
            .collect()
    }

    /// Why a controller for the model may not be one for the drive.
    pub(crate) fn doubt(&self) -> Option<String> {
        let mut doubts = Vec::new();
        if !self.found.estimate.reading.stable {
            doubts.push("is unstable".to_owned());
        }
        let found = self.found;
        let untold = found.poor_input.is_some() || found.delay_imitated.is_some();
        if untold || found.delay_untold() {
            doubts.push("does not tell its delay".to_owned());
        }
        if !(self.fits()[1] >= POOR) {
            doubts.push("is poor".to_owned());
        }
        // An offset and friction that are none are no doubt.
        let mut insignificant = self.insignificant();
        insignificant.retain(|name| name != "constant" && !name.ends_with("[sgn(v)]"));
        if !insignificant.is_empty() {
            doubts.push(format!("does not tell {} from 0", insignificant.join(", ")));
        }
        (!doubts.is_empty()).then(|| doubts.join(" and "))
    }

    /// Objections to the model.
    pub(crate) fn remarks(&self) -> Vec<&'static str> {
        let [x0, x0c] = self.fits();
        let mut remarks = Vec::new();
        if !self.found.estimate.reading.stable {
            remarks.push(
                "the model is unstable: no drive is, so the structure or the record does not fit",
            );
        }
        if !(x0c >= POOR) {
            remarks.push("this is poor: the structure may be wrong, see `trendid select`");
        } else if x0 < POOR {
            remarks.push(
                "it fits only with the constant refitted: the record has an offset or a drift that the model does not hold",
            );
        }
        if self.found.filter_dependence().is_some() {
            remarks.push(
                "filter poles at half or twice give another value of it: the structure does not hold all of the drive, and the deviations contain how far it moves",
            );
        }
        if self.diverged() {
            remarks.push(
                "the recursion diverged behind this filter: its errors of prediction are more than ten times those of the mean of the output, and say nothing of the model",
            );
        }
        if self.found.friction != Friction::Measured {
            remarks.push(
                "friction is that of the model, which reverses and rests where its own velocity does: the record is simulated better so than with measured signs",
            );
        }
        if self.found.delay_missed().is_some() && self.offset() {
            remarks.push(
                "an offset is in the record that the model does not hold: `--constant` first; where the delay is missed behind that too, `--delay auto` finds it, `trendid select` the structure",
            );
        } else if self.found.delay_missed().is_some() {
            remarks.push(
                "another delay, a lag or a lead is in the record: `--delay auto` finds the delay, `trendid select` the structure",
            );
        }
        match self.found.way {
            Way::WeakInstruments => remarks.push(
                "instruments are weak on this record, least squares took their place: noise of the output biases it",
            ),
            Way::Recursion => remarks.push(
                "by the recursion alone: noise of the output may bias it, and its standard deviations take the noise for white",
            ),
            Way::Instruments | Way::OutputError => {}
        }
        remarks
    }
}
