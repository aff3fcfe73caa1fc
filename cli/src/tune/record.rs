//! The plant of `trendid tune record`: a model, and what speaks against it.

use clap::Args;
use serde_json::{Value, json};
use trendid_identify::tune::Model;
use trendid_identify::{Choice, Freedom, Identification, Options, Problem, Structure, identify};

use crate::format::significant;
use crate::identify::parse::{delay, filter};
use crate::identify::report::{self, notes};
use crate::identify::signals::{Loaded, SignalArgs};
use crate::output::{Bar, Refusal, number};
use crate::tune::{LoopArgs, Plant};

/// A bandwidth so many times the rate of the filter is one at which the record says little.
const FAR: f64 = 10.0;

#[derive(Debug, Args)]
pub(super) struct RecordArgs {
    #[command(flatten)]
    signals: SignalArgs,
    /// Order of the model, 1 to 4, the integrator included
    #[arg(long, value_name = "M")]
    order: usize,
    /// The plant integrates: a0 = 0
    #[arg(long)]
    integrator: bool,
    /// Number of zeros
    #[arg(long, value_name = "K", default_value_t = 0)]
    zeros: usize,
    /// Delay of the plant in samples of the record, or the best
    #[arg(long, value_name = "D|auto", default_value = "auto", value_parser = delay)]
    delay: Choice<usize>,
    /// Filter poles in rad/s, or `auto`
    #[arg(long, value_name = "POLE|auto", default_value = "auto", value_parser = filter, allow_negative_numbers = true)]
    filter: Choice<Option<f64>>,
    /// Sample time of the controller in s; that of the record without
    #[arg(long, value_name = "S")]
    sample_time: Option<f64>,
    #[command(flatten)]
    pub(super) wanted: LoopArgs,
}

/// What the record says of its model.
pub(super) struct OfRecord {
    /// Name of the input that the controller moves.
    pub(super) input: String,
    pub(super) output: String,
    /// Rate of the filter that the model was found behind \[rad/s\].
    rate: Option<f64>,
    fits: [f64; 2],
    verdict: String,
    /// Why the gains may not be for the drive.
    doubt: Option<String>,
    /// Objections to the model, and what became of the other inputs.
    remarks: Vec<String>,
    /// Of the time stamps, in lines.
    notes: String,
}

impl OfRecord {
    /// Lines above the gains.
    pub(super) fn text(&self) -> String {
        let [x0, x0c] = self.fits;
        let mut text = format!(
            "{}fit {x0:.2} % (x0), {x0c:.2} % (x0+c), verdict: {}\n",
            self.notes, self.verdict
        );
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
        })
    }
}

impl RecordArgs {
    /// The model, those within two standard deviations and those of inputs like the first one.
    ///
    /// # Errors
    ///
    /// What is wrong with the record or the structure.
    pub(super) fn plant(&self) -> Result<Plant, Refusal> {
        let loaded = self.signals.load()?;
        let signals = loaded.signals();
        let structure = Structure {
            order: self.order,
            integrator: self.integrator,
            zeros: self.zeros,
            constant: self.signals.constant,
        };
        let options = Options {
            scheme: self.signals.scheme.into(),
            memory: None,
        };
        let problem = Problem::new(&signals, structure, options)?;
        let freedom = Freedom {
            pole: self.filter,
            delay: self.delay,
        };
        let bar = Bar::new("choosing filter and delay");
        let found = identify(&problem, freedom, 0, &bar)?;
        bar.finish();
        let delay = found.delay * loaded.dt;
        let mut around = Model::around(&problem, &found.estimate, delay);
        let mut of_record = self.of_record(&loaded, &problem, freedom, &found);
        let mut others = Model::others(&problem, &found.estimate, delay);
        // A power is no other direction, and the sign beside a dead zone no input of its own.
        let sign = |c: usize| c == 1 && loaded.dead_zone.is_some();
        others.retain(|(c, _)| !sign(*c) && !signals.inputs[*c].name.contains('^'));
        for (c, input) in signals.inputs.iter().enumerate().skip(1) {
            if !input.delayed || sign(c) {
                continue;
            }
            let (first, name) = (signals.inputs[0].name, input.name);
            let ratio = found.estimate.b[c][0] / found.estimate.b[0][0];
            let ratio = significant(ratio, 3);
            of_record.remarks.push(match others.iter().any(|(k, _)| *k == c) {
                true => format!(
                    "gains are for {first}; {name}, {ratio} times its gain, is among the models within 2 sigma"
                ),
                false => format!(
                    "gains are for {first}; {name}, {ratio} times its gain, is not used"
                ),
            });
        }
        around.extend(others.into_iter().map(|(_, model)| model));
        Ok(Plant {
            model: Model::of(&found.estimate, delay),
            around,
            sample_time: self.sample_time.unwrap_or(loaded.dt),
            record: Some(of_record),
        })
    }

    fn of_record(
        &self,
        loaded: &Loaded,
        problem: &Problem,
        freedom: Freedom,
        found: &Identification,
    ) -> OfRecord {
        let report = report::Report {
            file: &self.signals.file,
            output: &self.signals.output,
            start: loaded.start,
            jitter: loaded.jitter,
            granted: loaded.granted.as_deref(),
            dead_zone: loaded.dead_zone,
            problem,
            freedom,
            found,
        };
        OfRecord {
            input: problem.signals.inputs[0].name.to_owned(),
            output: self.signals.output.clone(),
            rate: match found.own_filter {
                Some(_) => Some(found.estimate.fastest()),
                None => found.pole,
            },
            fits: report.fits(),
            verdict: report.verdict(),
            doubt: report.doubt(),
            remarks: report.remarks().into_iter().map(str::to_owned).collect(),
            notes: notes(loaded.granted.as_deref(), loaded.jitter),
        }
    }
}
