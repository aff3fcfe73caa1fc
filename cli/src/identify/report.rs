//! Output of `trendid identify` for people.

use std::path::Path;

use trendid_identify::dead_zone::DeadZone;
use trendid_identify::derived::Quantity;
use trendid_identify::{Choice, Freedom, Friction, Identification, Problem, Way};

use crate::format::{polynomial, significant, table, transfer_function, with_sigma};
use crate::record::Notes;

/// Squared errors of prediction, over those of the mean of the output, beyond which the recursion
/// has diverged; of noise alone it predicts somewhat worse than the mean, too.
const DIVERGED: f64 = 100.0;

/// Everything that is printed.
pub(crate) struct Report<'a> {
    pub file: &'a Path,
    /// Name of the output column.
    pub output: &'a str,
    /// First time stamp \[s\].
    pub start: f64,
    /// What is said of the file.
    pub notes: &'a Notes,
    /// The dead zone that the first inputs are behind.
    pub dead_zone: Option<DeadZone>,
    pub problem: &'a Problem<'a>,
    pub freedom: Freedom,
    pub found: &'a Identification,
}

impl Report<'_> {
    pub(super) fn delay_s(&self) -> f64 {
        self.found.delay * self.problem.signals.dt
    }

    pub(crate) fn fits(&self) -> [f64; 2] {
        let free_run = self.found.free_run.as_ref();
        free_run.map_or([f64::NAN; 2], |f| [f.fit_x0, f.fit_x0c])
    }

    /// Seconds of standstill that were left out.
    pub(super) fn standstill_s(&self) -> f64 {
        if self.found.friction == Friction::HeldAtRest {
            return 0.0;
        }
        let still = self.problem.signals.standstill.into_iter().flatten();
        still.filter(|still| **still).count() as f64 * self.problem.signals.dt
    }

    /// The report for people.
    pub(super) fn text(&self) -> String {
        let mut text = self.head();
        text += &self.equations();
        let way = match self.found.way {
            Way::Instruments => "instruments",
            Way::OutputError => "output error",
            Way::WeakInstruments => "least squares (instruments are weak)",
            Way::Recursion => "value +- standard deviation",
        };
        let e = &self.found.estimate;
        let least_squares = self.found.least_squares.as_ref();
        let least_squares = least_squares.filter(|_| self.found.way == Way::Instruments);
        let mut rows = vec![vec!["parameter".to_owned(), way.to_owned()]];
        rows[0].extend(least_squares.map(|_| "least squares".to_owned()));
        for (j, name) in self.problem.parameter_names().into_iter().enumerate() {
            let mut row = vec![name, with_sigma(e.theta[j], e.sigma[j])];
            row.extend(least_squares.map(|e| with_sigma(e.theta[j], e.sigma[j])));
            rows.push(row);
        }
        text += &format!("\n{}\n", table(&rows));
        text += &table(&self.physical_rows());
        text + &self.conclusion()
    }

    /// The record, the filter, the delay, the memory.
    fn head(&self) -> String {
        let (p, found) = (self.problem, self.found);
        let end = self.start + (p.samples() - 1) as f64 * p.signals.dt;
        let filter = match (found.pole, &found.own_filter) {
            (None, _) => "raw trends".into(),
            (Some(_), Some(filter)) => format!(
                "filter 1/({}), the poles of the model itself (auto)",
                monic(filter)
            ),
            (Some(pole), None) => {
                let auto = match self.freedom.pole {
                    Choice::Auto => " (auto)",
                    Choice::Given(_) => "",
                };
                format!("filter poles at -{} rad/s{auto}", significant(pole, 3))
            }
        };
        let memory = p
            .options
            .memory
            .map_or("no forgetting".into(), |m| format!("memory {m} s"));
        let zone = match (self.dead_zone, p.signals.inputs.first()) {
            (Some(zone), Some(input)) => format!(
                "commands within {} of {} count as none in {}\n",
                significant(zone.half_width, 3),
                significant(zone.centre, 3),
                input.name
            ),
            _ => String::new(),
        };
        let delay = self.delay_text();
        let notes = self.notes.text();
        format!(
            "{}: {} samples every {} s, t = {} .. {} s\n{notes}{zone}{filter}, delay {delay}, {memory}\n\n",
            self.file.display(),
            p.samples(),
            significant(p.signals.dt, 5),
            stamp(self.start),
            stamp(end),
        )
    }

    /// The transfer function of each input, and the constant.
    fn equations(&self) -> String {
        let (p, e) = (self.problem, &self.found.estimate);
        let mut text = String::new();
        for (input, b) in p.signals.inputs.iter().zip(&e.b) {
            let delay = if input.delayed { self.delay_s() } else { 0.0 };
            text += &format!(
                "  {} / {:<6} = {}\n",
                self.output,
                input.name,
                transfer_function(b, &e.a, delay)
            );
        }
        if p.structure.constant {
            let mut a = e.a.clone();
            a.push(1.0);
            text += &format!(
                "  constant: ({}) {} = .. {} {}\n",
                polynomial(&a),
                self.output,
                if e.constant < 0.0 { '-' } else { '+' },
                significant(e.constant.abs(), 4)
            );
        }
        text
    }

    /// Whether the recursion predicts the output far worse than its mean does.
    pub(super) fn diverged(&self) -> bool {
        let (errors, y) = (self.found.errors, self.problem.signals.output);
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        let spread = y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / y.len() as f64;
        errors.samples > 0 && !(errors.ise <= DIVERGED * spread * errors.samples as f64)
    }

    /// The fits and what they say.
    fn conclusion(&self) -> String {
        let [x0, x0c] = self.fits();
        let model = if self.found.held_out {
            "model of the first half"
        } else {
            "model of the whole record, because the first half alone cannot carry the structure"
        };
        let fit = match self.found.free_run {
            Some(_) => format!("\n  fit {x0:.2} % (x0), {x0c:.2} % (x0+c)"),
            None => " it runs away".into(),
        };
        let mut text = format!("\n  free simulation of the second half ({model}):{fit}\n");
        let errors = self.found.errors;
        if errors.samples > 0 && !self.diverged() {
            text += &format!(
                "  one-step prediction of the recursion: ISE {}, IAE {} over {} samples\n",
                significant(errors.ise, 4),
                significant(errors.iae, 4),
                errors.samples
            );
        }
        if let Some(blocks) = self.found.effective_blocks {
            text += &format!(
                "  standard deviations from 16 blocks of the record, effectively {blocks:.0}\n"
            );
        }
        for remark in self.remarks() {
            text += &format!("  {remark}\n");
        }
        text + &format!("  verdict: {}\n", self.verdict())
    }

    fn physical_rows(&self) -> Vec<Vec<String>> {
        let e = &self.found.estimate;
        let r = &e.reading;
        let gain = match self.problem.structure.integrator {
            true => "velocity gain C",
            false => "static gain K",
        };
        let readings = [
            (gain, r.gain),
            ("natural frequency w0 [rad/s]", r.omega0),
            ("damping xi", r.damping),
        ];
        let mut rows = Vec::new();
        for (k, (name, value)) in readings.into_iter().enumerate() {
            if let Some(value) = value {
                let text = match self.reading_sigma(k) {
                    Some(sigma) => with_sigma(value, sigma),
                    None => significant(value, 4),
                };
                rows.push(vec![name.to_owned(), text]);
            }
        }
        let mut push = |name: String, q: Quantity| {
            rows.push(vec![name, with_sigma(q.value, q.sigma)]);
        };
        let unit = self.problem.signals.inputs[0].name;
        for (name, q) in self.further_gains() {
            push(format!("{gain} of {name}"), q);
        }
        if let Some(q) = self.problem.dead_zone(e) {
            push(format!("dead zone, half [{unit}]"), q);
        }
        for q in self.problem.time_constants(e) {
            push("time constant [s]".into(), q);
        }
        for (name, q) in self.problem.force_balance(e) {
            push(format!("{name} [{unit}]"), q);
        }
        for (re, im) in self.problem.poles(e) {
            let name = "pole [rad/s]".to_owned();
            let text = match im.value {
                0.0 => with_sigma(re.value, re.sigma),
                // Of a pair the one above the axis.
                im_value if im_value < 0.0 => continue,
                im_value => {
                    let (re, im) = (
                        with_sigma(re.value, re.sigma),
                        with_sigma(im_value, im.sigma),
                    );
                    format!("({re}) +-j ({im})")
                }
            };
            rows.push(vec![name, text]);
        }
        let stable = if r.stable { "yes" } else { "no" };
        rows.push(vec!["stable".into(), stable.into()]);
        rows
    }

    /// Standard deviation of gain, omega0 or damping: the core's, or that of b_0 over a_i.
    pub(super) fn reading_sigma(&self, k: usize) -> Option<f64> {
        let e = &self.found.estimate;
        match e.reading_sigma {
            Some(sigma) => Some(sigma[k]),
            None => (k == 0).then(|| self.problem.gain(e, 0).sigma),
        }
    }

    /// Gains of the delayed inputs behind the first.
    pub(super) fn further_gains(&self) -> Vec<(&str, Quantity)> {
        let inputs = self.problem.signals.inputs.iter().enumerate().skip(1);
        let behind_zone = self.dead_zone.is_some();
        inputs
            .filter(|(c, input)| input.delayed && !(*c == 1 && behind_zone))
            .map(|(c, input)| (input.name, self.problem.gain(&self.found.estimate, c)))
            .collect()
    }
}

/// A time stamp: with milliseconds where six digits would not tell it from another.
fn stamp(seconds: f64) -> String {
    match seconds.abs() < 1e6 {
        true => significant(seconds, 6),
        false => format!("{seconds:.3}"),
    }
}

/// A monic polynomial from its lower coefficients.
fn monic(lower: &[f64]) -> String {
    let mut f = lower.to_vec();
    f.push(1.0);
    polynomial(&f)
}
