//! Sampled signals, checked.

use std::ops::Range;

use trendid::trends::Hold;

use crate::error::Error;

/// One sampled input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input<'a> {
    /// Name of the column.
    pub name: &'a str,
    /// One value per sample of the output.
    pub samples: &'a [f64],
    /// Whether the zeros and the delay of the plant apply; without, one coefficient acts at once.
    pub delayed: bool,
    /// Course of the input between samples.
    pub hold: Hold,
}

/// Equally sampled signals.
#[derive(Debug, Clone, PartialEq)]
pub struct Signals<'a> {
    /// Sampling interval \[s\].
    pub dt: f64,
    /// The output y.
    pub output: &'a [f64],
    /// At most [`INPUTS`](crate::dynamic::INPUTS) inputs.
    pub inputs: Vec<Input<'a>>,
    /// Where the drive stands still and friction balances every force: nothing acts there, whatever
    /// the inputs are.
    pub standstill: Option<&'a [bool]>,
}

impl<'a> Signals<'a> {
    /// One input `u` that a digital output holds between the samples, and the output `y`.
    pub fn held(dt: f64, u: &'a [f64], y: &'a [f64]) -> Self {
        let input = Input {
            name: "u",
            samples: u,
            delayed: true,
            hold: Hold::Zero,
        };
        Self {
            dt,
            output: y,
            inputs: vec![input],
            standstill: None,
        }
    }

    /// Some samples of all signals.
    pub fn part(&self, range: Range<usize>) -> Self {
        let inputs = self.inputs.iter().map(|input| Input {
            samples: &input.samples[range.clone()],
            ..*input
        });
        Self {
            dt: self.dt,
            output: &self.output[range.clone()],
            inputs: inputs.collect(),
            standstill: self.standstill.map(|still| &still[range]),
        }
    }

    /// Whether the inputs and the constant act at a sample, which they do unless the drive stands
    /// still.
    pub fn acts(&self, sample: usize) -> bool {
        self.standstill.is_none_or(|still| !still[sample])
    }

    /// What acts of a value at a sample: nothing where the drive stands still.
    pub(crate) fn acting(&self, sample: usize, value: f64) -> f64 {
        if self.acts(sample) { value } else { 0.0 }
    }

    /// Refuses what carries no information whatever the structure.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if !(self.dt > 0.0 && self.dt.is_finite()) {
            return Err(Error::SampleTime(self.dt));
        }
        let (y, samples) = (self.output, self.output.len());
        for Input {
            name, samples: u, ..
        } in &self.inputs
        {
            if u.len() != samples {
                return Err(Error::Length {
                    name: (*name).to_owned(),
                    found: u.len(),
                    expected: samples,
                });
            }
            finite(&format!("`{name}`"), u)?;
            if !moves(u) {
                return Err(Error::InputConstant {
                    name: (*name).to_owned(),
                    samples,
                });
            }
        }
        finite("the output", y)?;
        match moves(y) {
            true => Ok(()),
            false => Err(Error::OutputConstant { samples }),
        }
    }
}

fn moves(x: &[f64]) -> bool {
    x.iter().any(|v| *v != x[0])
}

fn finite(name: &str, x: &[f64]) -> Result<(), Error> {
    match x.iter().position(|v| !v.is_finite()) {
        Some(sample) => Err(Error::NotFinite {
            name: name.to_owned(),
            sample,
            value: x[sample],
        }),
        None => Ok(()),
    }
}
