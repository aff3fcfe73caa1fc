//! Output of `trendid select`, for people and as JSON.

use std::path::Path;

use serde_json::{Value, json};
use trendid_identify::poor_input::PoorInput;
use trendid_identify::structure_choice::{Candidate, Dropped, Selection};
use trendid_identify::{Signals, Structure};

use crate::format::{counted, significant, table, with_sigma};
use crate::output::number;
use crate::record::Notes;

/// Fewer points of fit than this between the recommended structure and the best say that they are
/// alike.
const DOUBT: f64 = 2.0;

/// Everything that is printed.
pub(crate) struct SelectReport<'a> {
    pub(crate) file: &'a Path,
    pub(crate) signals: &'a Signals<'a>,
    /// What is said of the file.
    pub(crate) notes: &'a Notes,
    pub(crate) selection: &'a Selection,
}

impl SelectReport<'_> {
    fn recommended(&self) -> &Candidate {
        &self.selection.candidates[self.selection.recommended]
    }

    fn reason(&self) -> String {
        let best = &self.selection.candidates[self.selection.smallest];
        let c = self.recommended();
        if self.selection.recommended == self.selection.smallest {
            "the smallest error of simulation, and none with fewer parameters comes near".to_owned()
        } else {
            format!(
                "the fewest parameters ({}) among those that simulate about as well as the best ({}: {:.2} % with {})",
                parameters(c),
                describe(best),
                best.fit_x0c,
                counted(best.parameters(), "parameter")
            )
        }
    }

    /// Ties, the other kind of plant, and what speaks against the choice.
    fn doubts(&self) -> Vec<String> {
        let s = self.selection;
        let c = self.recommended();
        let mut doubts = Vec::new();
        for k in &s.alike {
            let other = &s.candidates[*k];
            if *k == s.recommended || other.parameters() > c.parameters() {
                continue;
            }
            doubts.push(format!(
                "a tie: {} has as many parameters and simulates about as well ({:.2} %)",
                describe(other),
                other.fit_x0c
            ));
        }
        let best = &s.candidates[s.smallest];
        if best.fit_x0c - c.fit_x0c > DOUBT {
            doubts.push(format!(
                "in doubt: {} simulates {:.1} points better, but not surely over the eighths of the record",
                describe(best),
                best.fit_x0c - c.fit_x0c
            ));
        }
        if let Some((dropped, shorter)) = s.lag() {
            let (structure, delay) = (dropped.structure, shorter.delay);
            doubts.push(format!(
                "in doubt: the delay may stand for a lag; {} simulates about as well ({:.2} %), with a parameter that is not significant",
                describe_at(structure, delay),
                shorter.fit_x0c
            ));
        }
        if let Some(poor) = s.poor_input {
            doubts.push(format!(
                "in doubt: the structure rests on {}, which no other signal confirms",
                poor.name()
            ));
        }
        if let Some(far) = c.filter_dependence() {
            doubts.push(format!(
                "{} depends on the filter ({} standard deviations; +- contains it): the structure does not hold all of the drive",
                c.names[0],
                significant(far, 2)
            ));
        }
        if c.delay_at_end {
            doubts.push("the delay is the longest that was tried".to_owned());
        }
        if c.fit_x0c < 50.0 {
            doubts
                .push("poor: no structure here simulates half of what the record shows".to_owned());
        }
        doubts
    }

    /// The report for people.
    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "{}: {} samples every {} s; each eighth simulated by the model of the rest\n{}\n",
            self.file.display(),
            self.signals.output.len(),
            significant(self.signals.dt, 5),
            self.notes.text()
        );
        text += &self.candidates();
        text += &self.dropped();
        let c = self.recommended();
        text += &format!("\nRecommended: {}: {}.\n", describe(c), self.reason());
        for doubt in self.doubts() {
            text += &format!("  {doubt}\n");
        }
        let e = &c.found.estimate;
        let mut rows = Vec::new();
        for ((name, value), sigma) in c.names.iter().zip(&e.theta).zip(&e.sigma) {
            let remark = if value.abs() < 2.0 * sigma {
                "not significant"
            } else {
                ""
            };
            rows.push(vec![
                name.clone(),
                with_sigma(*value, *sigma),
                remark.into(),
            ]);
        }
        if let Some(sigma) = c.delay_sigma {
            let delay = match c.delay_untold() {
                true => "not told by the record".into(),
                false => with_sigma(c.model_delay, sigma),
            };
            rows.push(vec!["delay [samples]".into(), delay, String::new()]);
        }
        text + &table(&rows)
    }

    /// One line per candidate.
    fn candidates(&self) -> String {
        let head = [
            "order",
            "integrator",
            "zeros",
            "delay",
            "filter",
            "parameters",
            "fit x0+c",
            "",
        ];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for (k, c) in self.selection.candidates.iter().enumerate() {
            let mark = match k {
                k if k == self.selection.recommended => "<== recommended",
                k if self.selection.alike.contains(&k) => "about as good",
                _ => "",
            };
            let mut row = structure_cells(c.structure).to_vec();
            row.extend([
                samples(c.compared_delay),
                significant(c.pole, 3),
                c.parameters().to_string(),
                format!("{:.2} %", c.fit_x0c),
                mark.to_owned(),
            ]);
            rows.push(row);
        }
        table(&rows)
    }

    /// One line for each structure that is missing among the candidates.
    fn dropped(&self) -> String {
        if self.selection.dropped.is_empty() {
            return String::new();
        }
        let head = ["order", "integrator", "zeros", "dropped because"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for d in &self.selection.dropped {
            let mut row = structure_cells(d.structure).to_vec();
            row.push(d.reason.to_string());
            rows.push(row);
        }
        format!("\n{}", table(&rows))
    }

    /// The report for machines.
    pub(crate) fn json(&self) -> Value {
        let s = self.selection;
        let numbers = |v: &[f64]| v.iter().map(|v| number(*v)).collect::<Vec<_>>();
        let one = |c: &Candidate| {
            json!({
                "order": c.structure.order,
                "integrator": c.structure.integrator,
                "zeros": c.structure.zeros,
                "delay": c.delay,
                "delay_s": number(c.model_delay * self.signals.dt),
                "delay_sigma_s": c.delay_sigma.map(|sigma| number(sigma * self.signals.dt)),
                "delay_at_end": c.delay_at_end,
                "filter_pole": number(c.pole),
                "parameters": c.names,
                "counted_parameters": c.parameters(),
                "filter_shifts": c.filter_shifts.map(|shifts| numbers(&shifts)),
                "theta": numbers(&c.found.estimate.theta),
                "sigma": numbers(&c.found.estimate.sigma),
                "fit_x0c_pct": number(c.fit_x0c),
            })
        };
        let missing = |d: &Dropped| {
            json!({
                "order": d.structure.order,
                "integrator": d.structure.integrator,
                "zeros": d.structure.zeros,
                "reason": d.reason.to_string(),
            })
        };
        json!({
            "candidates": s.candidates.iter().map(one).collect::<Vec<_>>(),
            "dropped": s.dropped.iter().map(missing).collect::<Vec<_>>(),
            "recommended": s.recommended,
            "alike": s.alike,
            "reason": self.reason(),
            "doubts": self.doubts(),
            "poor_input": s.poor_input.map(PoorInput::name),
            "granted": self.notes.granted,
            "alone": self.notes.alone_json(),
            "jitter": self.notes.resampling.jitter.map(number),
            "filled": self.notes.resampling.filled,
            "clock": self.notes.clock.map(number),
        })
    }
}

/// `4`, `5, with its delay`.
fn parameters(c: &Candidate) -> String {
    match c.long_delay() {
        true => format!("{}, with its delay", c.parameters()),
        false => c.parameters().to_string(),
    }
}

fn structure_cells(s: Structure) -> [String; 3] {
    [
        s.order.to_string(),
        if s.integrator { "yes" } else { "no" }.to_owned(),
        s.zeros.to_string(),
    ]
}

fn describe(c: &Candidate) -> String {
    describe_at(c.structure, c.compared_delay)
}

/// `2`, `0.49`.
fn samples(delay: f64) -> String {
    match delay.fract() == 0.0 {
        true => format!("{delay}"),
        false => format!("{delay:.2}"),
    }
}

fn describe_at(s: Structure, delay: f64) -> String {
    let plural = if delay == 1.0 { "" } else { "s" };
    format!(
        "order {}{}, {}, delay {} sample{plural}",
        s.order,
        if s.integrator { " with integrator" } else { "" },
        counted(s.zeros, "zero"),
        samples(delay)
    )
}
