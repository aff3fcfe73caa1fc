//! The part of a command line that names a record, its columns and its span.

use std::path::PathBuf;

use clap::Args;
use trendid::Scheme;

use crate::auto::Choice;
use crate::estimate::{Input, Problem};
use crate::freerun::Hold;
use crate::friction;
use crate::output::Refusal;
use crate::record::Record;

/// Most input columns beside each other that the run-time core offers.
const INPUTS: usize = trendid_identify::INPUTS;

/// Most parameters that it offers.
const PARAMETERS: usize = trendid_identify::PARAMETERS;

/// Record, columns and span.
#[derive(Debug, Args)]
pub struct SignalArgs {
    /// Record: `#` comments, a header line, then one line per sample
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// Column with the time stamps in s
    #[arg(long, value_name = "COL", default_value = "t")]
    pub time: String,
    /// Input column, or COL^K for its K-th power; may be repeated
    #[arg(long, value_name = "COL", default_value = "u")]
    pub input: Vec<String>,
    /// Output column
    #[arg(long, value_name = "COL", default_value = "y")]
    pub output: String,
    /// Add a constant input (offset); it comes out as 0 as long as the record does not show one
    #[arg(long)]
    pub constant: bool,
    /// Add sgn(v) as an input, v from COL or from the filtered position
    #[arg(long, value_name = "COL", num_args = 0..=1)]
    pub coulomb: Option<Option<String>>,
    /// What the inputs do between samples
    #[arg(long, value_enum, default_value = "zoh")]
    pub hold: Hold,
    /// First time stamp used [s]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    pub from: Option<f64>,
    /// Last time stamp used [s]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    pub to: Option<f64>,
    /// Trends of Goodwin (4) or modified Tustin (8)
    #[arg(long, value_enum, default_value = "tustin")]
    pub scheme: SchemeName,
}

/// The two schemes of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SchemeName {
    Goodwin,
    Tustin,
}

impl From<SchemeName> for Scheme {
    fn from(name: SchemeName) -> Self {
        match name {
            SchemeName::Goodwin => Self::Goodwin,
            SchemeName::Tustin => Self::Tustin,
        }
    }
}

/// The record with its signals in the roles of a model.
pub struct Signals {
    pub start: f64,
    pub dt: f64,
    pub y: Vec<f64>,
    /// Real inputs, then sgn(v) where wanted.
    pub inputs: Vec<Input>,
}

impl SignalArgs {
    /// Reads the record and cuts out the span asked for.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with the file, a column or the span.
    pub fn load(&self) -> Result<Signals, Refusal> {
        let count = self.input.len() + usize::from(self.coulomb.is_some());
        if count > INPUTS {
            return Err(Refusal::new(format!(
                "{count} inputs were asked for, at most {INPUTS} are possible"
            )));
        }
        for bound in [self.from, self.to].into_iter().flatten() {
            if !bound.is_finite() {
                return Err(Refusal::new(format!(
                    "the bound {bound} of the span is not a finite time in s"
                )));
            }
        }
        let powers = self
            .input
            .iter()
            .map(|name| power(name))
            .collect::<Result<Vec<_>, _>>()?;
        let mut columns = vec![self.output.clone()];
        columns.extend(powers.iter().map(|(column, _)| (*column).to_owned()));
        if let Some(Some(velocity)) = &self.coulomb {
            columns.push(velocity.clone());
        }
        let record =
            Record::read(&self.file, &self.time, &columns)?.window(self.from, self.to, 2)?;
        let mut signals = record.signals.into_iter();
        let y = signals.next().unwrap_or_default();
        let mut inputs: Vec<Input> = Vec::new();
        for ((name, (_, exponent)), samples) in self.input.iter().zip(&powers).zip(&mut signals) {
            inputs.push(Input {
                name: name.clone(),
                samples: samples.iter().map(|v| v.powi(*exponent)).collect(),
                terms: 1,
                delayed: true,
                hold: self.hold,
            });
        }
        if let Some(column) = &self.coulomb {
            let v = match (column, signals.next()) {
                (Some(_), Some(v)) => v,
                _ => friction::velocity(&y, record.dt)?,
            };
            inputs.push(Input {
                name: "sgn(v)".into(),
                samples: friction::signs(&v),
                terms: 1,
                delayed: false,
                hold: Hold::Zoh,
            });
        }
        Ok(Signals {
            start: record.start,
            dt: record.dt,
            y,
            inputs,
        })
    }

    /// The identification problem of one structure over the signals.
    ///
    /// # Errors
    ///
    /// An order or a number of zeros that is no structure, or too few samples for it.
    pub fn problem(
        &self,
        signals: &Signals,
        structure: StructureChoice,
    ) -> Result<Problem, Refusal> {
        let StructureChoice {
            order,
            integrator,
            zeros,
        } = structure;
        if !(1..=4).contains(&order) {
            return Err(Refusal::new(format!(
                "the order {order} is not one of 1, 2, 3, 4"
            )));
        }
        if zeros >= order {
            return Err(Refusal::new(format!(
                "{zeros} zeros need an order of at least {}, not {order}",
                zeros + 1
            )));
        }
        let mut inputs = signals.inputs.clone();
        for input in inputs.iter_mut().filter(|i| i.delayed) {
            input.terms = zeros + 1;
        }
        let problem = Problem {
            inputs,
            y: signals.y.clone(),
            dt: signals.dt,
            order,
            integrator,
            constant: self.constant,
            scheme: self.scheme.into(),
            memory: None,
        };
        let parameters = problem.parameter_names().len();
        if parameters > PARAMETERS {
            return Err(Refusal::new(format!(
                "the structure has {parameters} parameters, at most {PARAMETERS} are possible"
            )));
        }
        let (found, needed) = (problem.y.len(), problem.samples_needed());
        if found < needed {
            return Err(Refusal::new(format!(
                "too few samples: {found} for {parameters} parameters, at least {needed} are needed"
            )));
        }
        problem.check_excitation()?;
        Ok(problem)
    }
}

/// Order (integrator included), integrator, number of zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StructureChoice {
    pub order: usize,
    pub integrator: bool,
    pub zeros: usize,
}

/// `y^3` is the column y and the exponent 3.
fn power(name: &str) -> Result<(&str, i32), Refusal> {
    let Some((column, exponent)) = name.rsplit_once('^') else {
        return Ok((name, 1));
    };
    match exponent.parse() {
        Ok(e @ 1..=9) => Ok((column, e)),
        _ => Err(Refusal::new(format!(
            "the power in `{name}` is not a digit from 1 to 9"
        ))),
    }
}

/// `--filter POLE|auto|none` for clap.
pub fn parse_filter(text: &str) -> Result<Choice<Option<f64>>, String> {
    match text {
        "auto" => Ok(Choice::Auto),
        "none" => Ok(Choice::Given(None)),
        _ => match text.parse::<f64>() {
            Ok(pole) if pole > 0.0 && pole.is_finite() => Ok(Choice::Given(Some(pole))),
            _ => Err("expected a positive number of rad/s, `auto` or `none`".into()),
        },
    }
}

/// `--delay D|auto` for clap.
pub fn parse_delay(text: &str) -> Result<Choice<usize>, String> {
    let longest = trendid_identify::DELAY;
    match (text, text.parse::<usize>()) {
        ("auto", _) => Ok(Choice::Auto),
        (_, Ok(delay)) if delay <= longest => Ok(Choice::Given(delay)),
        _ => Err(format!(
            "expected a number of samples from 0 to {longest}, or `auto`"
        )),
    }
}
