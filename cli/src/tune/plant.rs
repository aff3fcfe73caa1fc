//! The plant of `trendid tune`, and what speaks against its model.

use serde_json::{Value, json};
use trendid_identify::tune::Model;

use crate::format::significant;
use crate::output::number;
use crate::record::Notes;

/// A bandwidth so many times the rate of the filter is one at which the record says little.
const FAR: f64 = 10.0;

/// A fit below this \[%\] is that of a simulation that runs away.
const RUNS_AWAY: f64 = -1e6;

/// The plant that gains are for.
pub(super) struct Plant {
    pub(super) model: Model,
    /// What the margins hold for, too.
    pub(super) around: Vec<Model>,
    /// Of the controller \[s\].
    pub(super) sample_time: f64,
    pub(super) record: Option<OfRecord>,
}

/// What the record says of its model.
pub(super) struct OfRecord {
    /// Name of the input that the controller moves.
    pub(super) input: String,
    pub(super) output: String,
    /// Rate of the filter that the model was found behind \[rad/s\].
    pub(super) rate: Option<f64>,
    pub(super) fits: [f64; 2],
    pub(super) verdict: String,
    /// Why the gains may not be for the drive.
    pub(super) doubt: Option<String>,
    /// Objections to the model, and what became of the other inputs.
    pub(super) remarks: Vec<String>,
    /// What is said of the file.
    pub(super) notes: Notes,
}

impl OfRecord {
    /// Lines above the gains.
    pub(super) fn text(&self) -> String {
        let (notes, fit) = (self.notes.text(), fit(self.fits));
        let mut text = format!("{notes}{fit}, verdict: {}\n", self.verdict);
        for remark in &self.remarks {
            text += &format!("  {remark}\n");
        }
        if let Some(doubt) = &self.doubt {
            text += &format!(
                "WARNING: the model {doubt}: these gains are for it, and hardly for the drive\n"
            );
        }
        text
    }

    /// What a bandwidth has against it.
    pub(super) fn warning(&self, bandwidth: f64) -> Option<String> {
        let rate = self.rate?;
        (bandwidth > FAR * rate).then(|| {
            format!(
                "{} times the rate of the filter ({} rad/s) that the model was found behind: the record says little of the drive there",
                significant(bandwidth / rate, 2),
                significant(rate, 3)
            )
        })
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "input": self.input,
            "filter_rate": self.rate.map(number),
            "fit_pct": number(self.fits[0]),
            "fit_x0c_pct": number(self.fits[1]),
            "verdict": self.verdict,
            "doubt": self.doubt,
            "remarks": self.remarks,
            "granted": self.notes.granted,
            "alone": self.notes.alone_json(),
        })
    }
}

/// The two fits in words.
fn fit(fits: [f64; 2]) -> String {
    let [x0, x0c] = fits;
    match fits.iter().all(|fit| *fit > RUNS_AWAY) {
        true => format!("fit {x0:.2} % (x0), {x0c:.2} % (x0+c)"),
        false => "the free simulation of the second half runs away".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::fit;

    #[test]
    fn a_simulation_that_runs_away_has_no_fit() {
        assert_eq!(fit([98.0, 99.5]), "fit 98.00 % (x0), 99.50 % (x0+c)");
        for x0 in [f64::NAN, -2.58e27, f64::NEG_INFINITY] {
            let said = "the free simulation of the second half runs away";
            assert_eq!(fit([x0, 12.0]), said);
            assert_eq!(fit([12.0, x0]), said);
        }
    }
}
