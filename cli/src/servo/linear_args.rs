//! Arguments of `trendid demo --linear` and `trendid simulate`: the noise of the linear servo.

use std::path::PathBuf;

use clap::Args;
use trendid_host_tests::plants::servo::Servo;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, Reading};
use trendid_identify::Choice;

use crate::format::{significant, transfer_function};
use crate::identify::names::SchemeName;
use crate::output::Refusal;

/// Widest noise \[um\]: a metre, of an axis that moves by tenths of it.
const WIDEST: f64 = 1e6;

/// Measurement of the simulated position.
#[derive(Debug, Clone, Args)]
pub(crate) struct NoiseArgs {
    /// Seed of command and noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Duration [s]
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    pub seconds: f64,
    /// Full width of the white noise of the position [um]
    #[arg(long, value_name = "UM", default_value_t = 20.0)]
    pub eta: f64,
    /// Full width of the slow drift of the position [um]
    #[arg(long, value_name = "UM", default_value_t = 200.0)]
    pub w: f64,
    /// Resolution of the position sensor [um]
    #[arg(long, value_name = "UM", default_value_t = 10.0)]
    pub eps: f64,
}

impl NoiseArgs {
    /// The reference servo under binary noise, measured as asked.
    ///
    /// # Errors
    ///
    /// The first value that makes no sense.
    pub(crate) fn record(&self) -> Result<Record, Refusal> {
        for (name, width) in [("eta", self.eta), ("w", self.w), ("eps", self.eps)] {
            if !(0.0..=WIDEST).contains(&width) {
                return Err(Refusal::new(format!(
                    "--{name} {} is not a width from 0 to {WIDEST} um",
                    significant(width, 3)
                )));
            }
        }
        if !(0.1..=600.0).contains(&self.seconds) {
            return Err(Refusal::new(format!(
                "--seconds {} is not between 0.1 and 600 s",
                self.seconds
            )));
        }
        let condition = Condition {
            w_um: self.w,
            eta_um: self.eta,
            eps_um: self.eps,
            dt_ms: 1.0,
            ns_pct: 0.0,
            reading: Reading::Absolute,
        };
        Ok(Experiment::reference(condition, self.seconds).record(self.seed))
    }
}

/// The servo's truth as comment lines of a record.
pub(crate) fn truth_lines(servo: &Servo) -> [String; 2] {
    [
        format!(
            "# truth: y(s)/u(s) = {}; a1 = {}, a2 = {}, b0 = {}",
            transfer_function(&[servo.b0()], &servo.a(), 0.0),
            servo.a()[1],
            servo.a()[2],
            servo.b0()
        ),
        format!(
            "# truth: C = {} mm/s per unit, w0 = {} rad/s, xi = {}",
            servo.c, servo.omega0, servo.xi
        ),
    ]
}

/// Options of the identification.
pub(crate) struct LinearArgs {
    pub noise: NoiseArgs,
    pub scheme: SchemeName,
    pub filter: Choice<Option<f64>>,
    pub out: PathBuf,
    pub json: bool,
}
