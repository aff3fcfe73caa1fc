//! Faults in `trendid loop --population N --faults M`.

use serde_json::{Map, Value, json};
use trendid_host_tests::servo::faults::fault::Fault;
use trendid_host_tests::servo::faults::normal::controlled;
use trendid_host_tests::servo::faults::summary::{FaultFigures, by_fault};
use trendid_host_tests::servo::faults::trial::{self, FaultRun, Situation};
use trendid_host_tests::servo::population::family::Family;

use crate::format::significant;
use crate::output::{Refusal, number, progress, under};

/// Most axes that are broken.
const AXES_MAX: u64 = 1000;

/// The figures of the faults in control and while commissioning.
pub(crate) struct FaultTables {
    control: Vec<(Fault, FaultFigures)>,
    commissioning: Vec<(Fault, FaultFigures)>,
    axes: usize,
    seeds: [u64; 2],
}

/// Breaks axes; nothing for none.
///
/// # Errors
///
/// A sentence on a number of axes that makes no sense.
pub(crate) fn run(
    family: Family,
    usual: bool,
    first: u64,
    axes: u64,
) -> Result<Option<FaultTables>, Refusal> {
    if axes == 0 {
        return Ok(None);
    }
    if axes > AXES_MAX {
        return Err(Refusal::new(format!(
            "--faults {axes} is not between 0 and {AXES_MAX}"
        )));
    }
    let axes = controlled(family, usual, first, axes as usize);
    let cases: Vec<_> = axes
        .iter()
        .flat_map(|axis| Situation::ALL.map(|situation| (axis, situation)))
        .flat_map(|(axis, situation)| Fault::ALL.map(|fault| (axis, situation, fault)))
        .collect();
    let bar = progress(cases.len() as u64, "faults");
    let runs = under(&bar, &cases, |(axis, situation, fault)| {
        trial::run(axis, *situation, *fault)
    });
    bar.finish_and_clear();
    let (commissioning, control): (Vec<FaultRun>, Vec<FaultRun>) = runs
        .into_iter()
        .flatten()
        .partition(|run| run.situation == Situation::Commissioning);
    let last = axes.last().map_or(first, |axis| axis.seed);
    Ok(Some(FaultTables {
        control: by_fault(&control),
        commissioning: by_fault(&commissioning),
        axes: axes.len(),
        seeds: [first, last],
    }))
}

fn object(figures: &[(Fault, FaultFigures)]) -> Value {
    let rows = figures.iter().map(|(fault, f)| {
        let row = json!({
            "runs": f.runs,
            "detected_pct": number(f.detected_pct),
            "right_reason_pct": number(f.right_reason_pct),
            "end_stop_max_mm_s": number(f.end_stop_max_mm_s),
            "avoidable_max_mm_s": number(f.avoidable_max_mm_s),
            "avoidable_pct": number(f.avoidable_pct),
            "noticed_median_s": number(f.noticed_median_s),
            "reasons": f.reasons,
        });
        (fault.name().to_owned(), row)
    });
    Value::Object(rows.collect())
}

impl FaultTables {
    /// Adds the figures to those of the population.
    pub(crate) fn insert_into(&self, top: &mut Map<String, Value>) {
        top.insert("faults".into(), object(&self.control));
        top.insert(
            "faults_in_commissioning".into(),
            object(&self.commissioning),
        );
    }

    /// Two tables.
    pub(crate) fn markdown(&self) -> String {
        let [first, last] = self.seeds;
        let axes = self.axes;
        let mut text = format!(
            "\n{axes} axes with seeds {first} to {last} that a model near the truth controls. Blows in mm/s; one can be \
             avoided when a valve that closes at the moment of the fault avoids it.\n"
        );
        for (title, figures) in [
            ("fault in control", &self.control),
            ("while commissioning", &self.commissioning),
        ] {
            text += &format!(
                "\n| {title} | runs | noticed [%] | right reason [%] | median [s] | hardest blow | avoidable | [%] |\n\
                 |---|---|---|---|---|---|---|---|\n"
            );
            for (fault, f) in figures {
                let numbers = [
                    f.detected_pct,
                    f.right_reason_pct,
                    f.noticed_median_s,
                    f.end_stop_max_mm_s,
                    f.avoidable_max_mm_s,
                    f.avoidable_pct,
                ];
                text += &format!("| {} | {} |", fault.name(), f.runs);
                for value in numbers {
                    let value = if value.is_nan() {
                        String::new()
                    } else {
                        significant(value, 3)
                    };
                    text += &format!(" {value} |");
                }
                text.push('\n');
            }
        }
        text
    }
}
