//! The part of a command line that names a record, its columns and its span.

use std::path::PathBuf;

use clap::Args;
use trendid_identify::dead_zone::DeadZone;
use trendid_identify::derived::{COULOMB, sign_of};
use trendid_identify::dynamic::INPUTS;
use trendid_identify::{
    Choice, Error, Freedom, Hold, Identification, Input, Problem, Signals, coulomb_input,
    standstill,
};

use crate::format::significant;
use crate::identify::names::{HoldName, SchemeName, TimeUnit};
use crate::identify::parse::{interval, power, width};
use crate::identify::report::Report;
use crate::output::Refusal;
use crate::record::{Clock, Notes, Record};

/// Record, columns and span.
#[derive(Debug, Args)]
pub(crate) struct SignalArgs {
    /// Record: `#` comments, a header line, then one line per sample; `-` for the standard input
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// Column with the time stamps; without a column `t` the only one such as `t_ms` or `time [us]`
    #[arg(long, value_name = "COL", default_value = "t")]
    pub time: String,
    /// Unit of the time stamps; without, that in the name of their column, or s
    #[arg(long, value_enum)]
    pub time_unit: Option<TimeUnit>,
    /// Sampling interval in s; the time stamps are then not read
    #[arg(long, value_name = "S", value_parser = interval, allow_negative_numbers = true, conflicts_with_all = ["time", "time_unit"])]
    pub dt: Option<f64>,
    /// Input column, or COL^K for its K-th power; may be repeated
    #[arg(long, value_name = "COL", default_value = "u")]
    pub input: Vec<String>,
    /// Output column
    #[arg(long, value_name = "COL", default_value = "y")]
    pub output: String,
    /// Half width of the dead zone of a valve, in the unit of the first input: commands inside are
    /// taken as 0, and sgn of those outside is a further input; or `auto`, the width and
    /// the centre whose model simulates eighths of the record that it has not seen best (only for
    /// `identify`)
    #[arg(long, value_name = "WIDTH|auto", value_parser = width, allow_negative_numbers = true)]
    pub dead_zone: Option<Choice<f64>>,
    /// Add a constant input (offset); its standard deviation says whether the record shows one
    #[arg(long)]
    pub constant: bool,
    /// Add sgn(v) as an input, v from COL or from the filtered position
    #[arg(long, value_name = "COL", num_args = 0..=1)]
    pub coulomb: Option<Option<String>>,
    /// Course of the inputs between samples
    #[arg(long, value_enum, default_value = "zoh")]
    pub hold: HoldName,
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

/// The signals of a record in the roles of a model.
pub(crate) struct Loaded {
    /// First time stamp \[s\].
    pub start: f64,
    /// Sampling interval \[s\].
    pub dt: f64,
    /// What is said of the file.
    pub notes: Notes,
    y: Vec<f64>,
    /// The dead zone of the valve that the first inputs are behind.
    pub dead_zone: Option<DeadZone>,
    /// Real inputs, then sgn(v) where wanted.
    inputs: Vec<LoadedInput>,
    /// Where friction holds the drive, with sgn(v) as an input only.
    standstill: Option<Vec<bool>>,
}

struct LoadedInput {
    name: String,
    samples: Vec<f64>,
    delayed: bool,
    hold: Hold,
}

impl LoadedInput {
    /// The largest distance of a sample from a value.
    fn farthest(&self, from: f64) -> f64 {
        let distance = self.samples.iter().map(|u| (u - from).abs());
        distance.fold(0.0, f64::max)
    }

    /// Takes what passes a dead zone; gives the sign of it as another input.
    fn behind(&mut self, zone: DeadZone) -> Self {
        let [through, signs] = zone.inputs(&self.samples);
        self.samples = through;
        Self {
            name: sign_of(&self.name),
            samples: signs,
            ..*self
        }
    }
}

impl Loaded {
    /// Why the record carries no model, with the numbers that may be the cause.
    pub(crate) fn refusal(&self, error: Error) -> Refusal {
        self.notes.with_cause(&error.to_string()).into()
    }

    /// The signals as the library takes them.
    pub(crate) fn signals(&self) -> Signals<'_> {
        let inputs = self.inputs.iter().map(|input| Input {
            name: &input.name,
            samples: &input.samples,
            delayed: input.delayed,
            hold: input.hold,
        });
        Signals {
            dt: self.dt,
            output: &self.y,
            inputs: inputs.collect(),
            standstill: self.standstill.as_deref(),
        }
    }
}

impl SignalArgs {
    /// The report of what was found in the record.
    pub(crate) fn report<'a>(
        &'a self,
        loaded: &'a Loaded,
        problem: &'a Problem<'a>,
        freedom: Freedom,
        found: &'a Identification,
    ) -> Report<'a> {
        Report {
            file: &self.file,
            output: &self.output,
            start: loaded.start,
            notes: &loaded.notes,
            dead_zone: loaded.dead_zone,
            problem,
            freedom,
            found,
        }
    }

    /// Reads the record and cuts out the span asked for.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with the file, a column or the span.
    pub(crate) fn load(&self) -> Result<Loaded, Refusal> {
        let zone = match self.dead_zone {
            None => None,
            Some(Choice::Given(half_width)) => Some(DeadZone {
                half_width,
                centre: 0.0,
            }),
            Some(Choice::Auto) => {
                return Err(Refusal::new(
                    "--dead-zone auto needs the structure of a model: `trendid identify` finds the width, give it here",
                ));
            }
        };
        let powers = self.powers()?;
        self.assembled(&self.record(&powers)?, &powers, zone)
    }

    /// The same behind the dead zone that `find` takes from signals without one, and behind that of
    /// their first half.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load); those of `find`.
    pub(crate) fn load_finding(
        &self,
        find: impl Fn(&Signals) -> Result<DeadZone, Error>,
    ) -> Result<[Loaded; 2], Refusal> {
        let powers = self.powers()?;
        let record = self.record(&powers)?;
        let plain = self.assembled(&record, &powers, None)?;
        let signals = plain.signals();
        let whole = find(&signals)?;
        let half = find(&signals.part(0..signals.output.len() / 2)).unwrap_or(whole);
        Ok([
            self.assembled(&record, &powers, Some(whole))?,
            self.assembled(&record, &powers, Some(half))?,
        ])
    }

    /// Columns and exponents of the inputs.
    fn powers(&self) -> Result<Vec<(&str, i32)>, Refusal> {
        self.check()?;
        self.input.iter().map(|name| power(name)).collect()
    }

    /// The signals of a record in their roles.
    fn assembled(
        &self,
        record: &Record,
        powers: &[(&str, i32)],
        zone: Option<DeadZone>,
    ) -> Result<Loaded, Refusal> {
        let mut signals = record.signals.iter().cloned();
        let y = signals.next().unwrap_or_default();
        let mut inputs = Vec::new();
        for ((name, (_, exponent)), samples) in self.input.iter().zip(powers).zip(&mut signals) {
            inputs.push(LoadedInput {
                name: name.clone(),
                samples: samples.iter().map(|v| v.powi(*exponent)).collect(),
                delayed: true,
                hold: self.hold.into(),
            });
        }
        if let (Some(zone), Some(u)) = (zone, inputs.first_mut()) {
            let largest = u.farthest(zone.centre);
            if largest > 0.0 && largest <= zone.half_width {
                return Err(Refusal::new(format!(
                    "the dead zone of {} swallows the whole input `{}`, which goes up to {} at most: give a narrower one",
                    zone.half_width,
                    u.name,
                    significant(largest, 4)
                )));
            }
            let sign = u.behind(zone);
            inputs.insert(1, sign);
        }
        let mut still = None;
        if let Some(column) = &self.coulomb {
            let v = match (column, signals.next()) {
                (Some(_), Some(v)) => v,
                _ => coulomb_input::velocity(&y, record.dt)?,
            };
            inputs.push(LoadedInput {
                name: COULOMB.into(),
                samples: coulomb_input::signs(&v),
                delayed: false,
                hold: Hold::Zero,
            });
            still = standstill::standstill(&y);
        }
        Ok(Loaded {
            standstill: still,
            start: record.start,
            dt: record.dt,
            notes: record.notes.clone(),
            y,
            dead_zone: zone,
            inputs,
        })
    }

    /// Refuses more inputs than fit, and a span without bounds.
    fn check(&self) -> Result<(), Refusal> {
        let more = [self.dead_zone.is_some(), self.coulomb.is_some()];
        let count = self.input.len() + more.map(usize::from).iter().sum::<usize>();
        if count > INPUTS {
            return Err(Error::Inputs(count).into());
        }
        for bound in [self.from, self.to].into_iter().flatten() {
            if !bound.is_finite() {
                return Err(Refusal::new(format!(
                    "the bound {bound} of the span is not a finite time in s"
                )));
            }
        }
        Ok(())
    }

    /// The span of the record with the columns of output, inputs and velocity, in this order.
    fn record(&self, powers: &[(&str, i32)]) -> Result<Record, Refusal> {
        let mut columns = vec![self.output.clone()];
        columns.extend(powers.iter().map(|(column, _)| (*column).to_owned()));
        if let Some(Some(velocity)) = &self.coulomb {
            columns.push(velocity.clone());
        }
        let clock = Clock {
            column: &self.time,
            unit: self.time_unit.map(TimeUnit::seconds),
            dt: self.dt,
            held: self.hold == HoldName::Zoh,
            span: [self.from, self.to],
        };
        Ok(Record::read(&self.file, clock, &columns)?.window(self.from, self.to, 2)?)
    }
}
