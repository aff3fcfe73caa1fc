//! The plant of `trendid tune record`: a model, and what speaks against it.

use clap::Args;
use trendid_identify::tune::Model;
use trendid_identify::{Choice, Freedom, Identification, Options, Problem, identify};

use crate::format::significant;
use crate::identify::parse::{delay, filter};
use crate::identify::signals::{Loaded, SignalArgs};
use crate::identify::structure::StructureArgs;
use crate::output::{Bar, Refusal};
use crate::tune::args::LoopArgs;
use crate::tune::plant::{OfRecord, Plant};

#[derive(Debug, Args)]
pub(super) struct RecordArgs {
    #[command(flatten)]
    signals: SignalArgs,
    #[command(flatten)]
    structure: StructureArgs,
    /// Delay of the plant in samples of the record, or the best
    #[arg(long, value_name = "D|auto", default_value = "auto", value_parser = delay, allow_negative_numbers = true)]
    delay: Choice<usize>,
    /// Filter poles in rad/s, or `auto`
    #[arg(long, value_name = "POLE|auto", default_value = "auto", value_parser = filter, allow_negative_numbers = true)]
    filter: Choice<Option<f64>>,
    /// Sample time of the controller in s; that of the record without
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    sample_time: Option<f64>,
    #[command(flatten)]
    pub(super) wanted: LoopArgs,
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
        let structure = self.structure.with(self.signals.constant);
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
        let found = identify(&problem, freedom, 0, &bar).map_err(|error| loaded.refusal(error))?;
        bar.finish();
        let delay = found.delay * loaded.dt;
        let mut around = Model::around(&problem, &found);
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
        let report = self.signals.report(loaded, problem, freedom, found);
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
            notes: loaded.notes.clone(),
        }
    }
}
