//! The part of a command line that names a record, its columns and its span.

use std::path::PathBuf;

use clap::Args;
use trendid_identify::derived::COULOMB;
use trendid_identify::dynamic::INPUTS;
use trendid_identify::{Error, Hold, Input, Scheme, Signals, coulomb_input, standstill};

use crate::identify::parse::{interval, power, width};
use crate::output::Refusal;
use crate::record::{Clock, Record};

/// Record, columns and span.
#[derive(Debug, Args)]
pub(crate) struct SignalArgs {
    /// Record: `#` comments, a header line, then one line per sample; `-` for the standard input
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// Column with the time stamps
    #[arg(long, value_name = "COL", default_value = "t")]
    pub time: String,
    /// Unit of the time stamps, s without; needed where the name of the column says another one
    #[arg(long, value_enum)]
    pub time_unit: Option<TimeUnit>,
    /// Sampling interval in s; the time stamps are then not read
    #[arg(long, value_name = "S", value_parser = interval)]
    pub dt: Option<f64>,
    /// Input column, or COL^K for its K-th power; may be repeated
    #[arg(long, value_name = "COL", default_value = "u")]
    pub input: Vec<String>,
    /// Output column
    #[arg(long, value_name = "COL", default_value = "y")]
    pub output: String,
    /// Half width of the dead zone of a valve, in the unit of the first input: commands inside are taken as 0, and sgn of those
    /// outside is a further input; -b0[sgn(u)] / b0[u] is the width that the record shows
    #[arg(long, value_name = "WIDTH", value_parser = width)]
    pub dead_zone: Option<f64>,
    /// Add a constant input (offset); it comes out as 0 as long as the record does not show one
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

/// Unit of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum TimeUnit {
    S,
    Ms,
    Us,
    Ns,
}

impl TimeUnit {
    const fn seconds(self) -> f64 {
        match self {
            Self::S => 1.0,
            Self::Ms => 1e-3,
            Self::Us => 1e-6,
            Self::Ns => 1e-9,
        }
    }
}

/// How an input behaves between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum HoldName {
    /// Zero-order hold: constant until the next sample.
    Zoh,
    /// First-order hold: straight to the next sample.
    Foh,
}

impl From<HoldName> for Hold {
    fn from(name: HoldName) -> Self {
        match name {
            HoldName::Zoh => Self::Zero,
            HoldName::Foh => Self::First,
        }
    }
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

/// The signals of a record in the roles of a model.
pub(crate) struct Loaded {
    /// First time stamp \[s\].
    pub start: f64,
    /// Sampling interval \[s\].
    pub dt: f64,
    /// The largest departure of a time step, relative to the interval, where the samples were moved to equal intervals.
    pub jitter: Option<f64>,
    y: Vec<f64>,
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
    /// Takes what a valve with a dead zone of this half width lets pass; gives the other input that such a valve is linear in, the
    /// sign of it (`trendid::inputs::dead_zone`).
    fn behind_dead_zone(&mut self, width: f64) -> Self {
        for u in &mut self.samples {
            *u = if u.abs() > width { *u } else { 0.0 };
        }
        let sign = |u: &f64| if *u == 0.0 { 0.0 } else { u.signum() };
        Self {
            name: format!("sgn({})", self.name),
            samples: self.samples.iter().map(sign).collect(),
            ..*self
        }
    }
}

impl Loaded {
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
    /// Reads the record and cuts out the span asked for.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with the file, a column or the span.
    pub(crate) fn load(&self) -> Result<Loaded, Refusal> {
        self.check()?;
        let powers = self
            .input
            .iter()
            .map(|name| power(name))
            .collect::<Result<Vec<_>, _>>()?;
        let record = self.record(&powers)?;
        let mut signals = record.signals.into_iter();
        let y = signals.next().unwrap_or_default();
        let mut inputs = Vec::new();
        for ((name, (_, exponent)), samples) in self.input.iter().zip(&powers).zip(&mut signals) {
            inputs.push(LoadedInput {
                name: name.clone(),
                samples: samples.iter().map(|v| v.powi(*exponent)).collect(),
                delayed: true,
                hold: self.hold.into(),
            });
        }
        if let (Some(width), Some(u)) = (self.dead_zone, inputs.first_mut()) {
            let sign = u.behind_dead_zone(width);
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
        for input in &mut inputs {
            let samples = input.samples.iter_mut().zip(still.iter().flatten());
            samples
                .filter(|(_, still)| **still)
                .for_each(|(u, _)| *u = 0.0);
        }
        Ok(Loaded {
            standstill: still,
            start: record.start,
            dt: record.dt,
            jitter: record.jitter,
            y,
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
        };
        Ok(Record::read(&self.file, clock, &columns)?.window(self.from, self.to, 2)?)
    }
}
