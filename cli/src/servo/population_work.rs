//! `trendid loop --population N --work S`: work without a fault, in which every alarm is a false
//! one.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use trendid_host_tests::servo::faults::normal::{FAR, NormalRun, controlled, untold_work, work};
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;

use crate::format::significant;
use crate::output::{Refusal, emit, emit_json, number, progress, under};

/// Longest work of an axis in s: a week.
const SECONDS_MAX: f64 = 604_800.0;

/// The work of many axes.
struct Worked {
    runs: Vec<NormalRun>,
    hours: f64,
    /// Why loops stopped, with the number of axes.
    alarms: BTreeMap<String, usize>,
    implausible: u64,
    oscillations: u64,
    models: u64,
    /// Time with a model of another natural frequency, and of another velocity gain, over all
    /// \[%\].
    far_pct: [f64; 2],
}

/// The axes that work.
pub(super) struct Drawn {
    pub(super) family: Family,
    pub(super) usual: bool,
    /// Whether the loop commissions them, instead of the first that a model near the truth
    /// controls.
    pub(super) untold: bool,
}

impl Drawn {
    fn axes(&self, first: u64, axes: u64) -> Vec<AxisDraw> {
        let Self { family, usual, .. } = *self;
        if self.untold {
            let seeds = first..first + axes;
            seeds
                .map(|seed| AxisDraw::new(family, usual, seed))
                .collect()
        } else {
            controlled(family, usual, first, axes as usize)
        }
    }
}

/// Lets axes work and prints.
///
/// # Errors
///
/// A sentence on a time that makes no sense.
pub(super) fn run(
    drawn: &Drawn,
    axes: u64,
    first: u64,
    seconds: f64,
    json: bool,
) -> Result<(), Refusal> {
    if !(seconds > 0.0 && seconds <= SECONDS_MAX) {
        return Err(Refusal::new(format!(
            "--work {seconds} is not between 0 and {SECONDS_MAX} s"
        )));
    }
    let axes = drawn.axes(first, axes);
    let bar = progress(axes.len() as u64, "axes");
    let works = if drawn.untold { untold_work } else { work };
    let runs = under(&bar, &axes, |axis| works(axis, seconds));
    bar.finish_and_clear();
    let worked = Worked::new(runs.into_iter().flatten().collect());
    if json {
        emit_json(&worked.object())?;
    } else {
        emit(&worked.markdown(drawn))?;
    }
    Ok(())
}

impl Worked {
    fn new(runs: Vec<NormalRun>) -> Self {
        let mut alarms = BTreeMap::new();
        for (reason, _) in runs.iter().filter_map(|run| run.stopped) {
            *alarms.entry(format!("{reason:?}")).or_insert(0) += 1;
        }
        let worked_s: f64 = runs.iter().map(|run| run.worked_s).sum();
        Self {
            hours: worked_s / 3600.0,
            implausible: runs.iter().map(|run| u64::from(run.implausible)).sum(),
            oscillations: runs.iter().map(|run| u64::from(run.oscillations)).sum(),
            models: runs.iter().map(|run| u64::from(run.models)).sum(),
            far_pct: [0, 1].map(|k| {
                let far: f64 = runs.iter().map(|run| run.far_s[k]).sum();
                100.0 * far / worked_s
            }),
            alarms,
            runs,
        }
    }

    fn stopped(&self) -> Vec<u64> {
        let stopped = self.runs.iter().filter(|run| run.stopped.is_some());
        stopped.map(|run| run.seed).collect()
    }

    fn object(&self) -> Value {
        json!({
            "axes": self.runs.len(),
            "worked_h": number(self.hours),
            "false_alarms": self.stopped().len(),
            "reasons": self.alarms,
            "stopped_seeds": self.stopped(),
            "implausible_readings": self.implausible,
            "oscillations": self.oscillations,
            "models": self.models,
            "frequency_far_pct": number(self.far_pct[0]),
            "gain_far_pct": number(self.far_pct[1]),
        })
    }

    fn markdown(&self, drawn: &Drawn) -> String {
        let kind = if drawn.usual { "usual " } else { "" };
        let model = if drawn.untold {
            "that a loop has commissioned which was told sample time, travel and limits of motion"
        } else {
            "that a model near the truth controls"
        };
        let seeds = self.runs.iter().map(|run| run.seed);
        let (low, high) = (seeds.clone().min().unwrap_or(0), seeds.max().unwrap_or(0));
        let mut text = format!(
            "{} {kind}{} axes with seeds {low} to {high} {model}; moves, sines of 0.1 to 5 Hz, small \
             steps, rests; no fault.\n\n| work | |\n|---|---|\n",
            self.runs.len(),
            drawn.family.name()
        );
        text += &format!(
            "| hours, all axes together | {} |\n",
            significant(self.hours, 3)
        );
        text += &format!(
            "| axes that the loop stopped | {} |\n",
            self.stopped().len()
        );
        for (reason, axes) in &self.alarms {
            text += &format!("| stopped: {reason} [axes] | {axes} |\n");
        }
        text += &format!(
            "| readings replaced as implausible | {} |\n",
            self.implausible
        );
        text += &format!("| oscillations noticed | {} |\n", self.oscillations);
        text += &format!("| models that replaced another | {} |\n", self.models);
        for (what, far) in ["natural frequency", "velocity gain"]
            .iter()
            .zip(self.far_pct)
        {
            text += &format!(
                "| time on a model whose {what} is off by more than a factor of {FAR} [%] | {} |\n",
                significant(far, 2)
            );
        }
        text
    }
}
