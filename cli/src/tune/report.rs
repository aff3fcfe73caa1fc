//! What `trendid tune` prints.

use serde_json::{Value, json};
use trendid_identify::tune::{Gains, Goal, Margins, Pid, SampledPlant, Tuned, TunedLoop};

use crate::format::{counted, significant, transfer_function};
use crate::output::number;
use crate::tune::plant::{OfRecord, Plant};

/// Significant digits of a gain.
const DIGITS: usize = 6;

pub(super) struct Report<'a> {
    pub(super) plant: &'a Plant,
    pub(super) goal: Goal,
    pub(super) tuned: &'a Tuned,
}

fn gain(value: f64) -> String {
    significant(value, DIGITS)
}

/// `3.2 (10.1 dB)`.
fn factor(value: f64) -> String {
    match value.is_finite() {
        true => format!("{} ({:.1} dB)", significant(value, 3), 20.0 * value.log10()),
        false => "none".into(),
    }
}

fn margins(what: &str, m: &Margins) -> String {
    let limited = |value: f64, unit: &str| match value.is_finite() {
        true => format!("{} {unit}", significant(value, 3)),
        false => "none".into(),
    };
    format!(
        "  {what:<18} gain {}, phase {}, delay {}, max sensitivity {}{}\n",
        factor(m.gain),
        limited(m.phase_deg, "deg"),
        limited(m.delay, "s"),
        significant(m.max_sensitivity, 3),
        if m.stable { "" } else { ", UNSTABLE" }
    )
}

impl Report<'_> {
    /// The report for people.
    pub(super) fn text(&self) -> String {
        let Self { plant, goal, tuned } = self;
        let (model, record) = (&plant.model, plant.record.as_ref());
        let (output, input) = record.map_or(("y", "u"), |r| (&r.output, &r.input));
        let samples = model.delay / goal.sample_time;
        let samples = match samples == 1.0 {
            true => "1 sample".into(),
            false => format!("{} samples", significant(samples, 3)),
        };
        let mut text = record.map_or(String::new(), OfRecord::text);
        text += &format!(
            "{output} / {input} = {}\ncontroller every {} s, delay of the plant {samples}\n",
            transfer_function(&model.b, &model.a, model.delay),
            goal.sample_time
        );
        for found in &tuned.loops {
            text += &format!(
                "\n{}, bandwidth {} rad/s{}\n",
                title(&found.gains),
                significant(found.bandwidth, 4),
                if goal.bandwidth.is_none() {
                    " (auto)"
                } else {
                    ""
                }
            );
            if let Some(warning) = record.and_then(|record| record.warning(found.bandwidth)) {
                text += &format!("  WARNING: {warning}\n");
            }
            text += &self.gains(&found.gains);
            text += &margins("margins", &found.margins);
            if let Some(worst) = &found.worst {
                text += &margins("within 2 sigma", worst);
            }
            text += &self.step(found);
        }
        for (kind, reason) in &tuned.refused {
            text += &format!("\nno {kind}: {reason}\n");
        }
        let terms: Vec<String> = tuned
            .feedforward
            .iter()
            .enumerate()
            .filter(|(_, value)| **value != 0.0)
            .map(|(i, value)| format!("{} r{}", gain(*value), "'".repeat(i)))
            .collect();
        text += &format!("\nfeedforward        u += {}\n", terms.join(" + "));
        text
    }

    fn gains(&self, gains: &Gains) -> String {
        let dt = self.goal.sample_time;
        match gains {
            Gains::Cascade(c) => format!(
                "  kv = {} 1/s, kp = {}, ti = {} s, velocity filter tf = {} s\n  \
                 v += {} ((y - y1)/T - v); e = kv (r - y) - v; u = kp e + I; I += {} e\n",
                gain(c.kv),
                gain(c.kp),
                gain(c.ti),
                gain(c.tf),
                gain(dt / (c.tf + dt)),
                gain(c.kp * dt / c.ti),
            ),
            Gains::Pid(c) => pid(c, dt),
            Gains::StateFeedback(c) => {
                let list = |values: &[f64]| {
                    let each: Vec<String> = values.iter().map(|v| gain(*v)).collect();
                    each.join(", ")
                };
                let states = match c.derivatives {
                    true => "y and its derivatives",
                    false => "w and its derivatives, A(s) w = u and y = B(s) w",
                };
                let input = match c.k_input == 0.0 {
                    true => String::new(),
                    false => format!(", of the input before {}", gain(c.k_input)),
                };
                format!(
                    "  {} of {states}: k = [{}]{input}, of the reference {}\n  observer l = [{}], the last of the disturbance\n",
                    counted(c.k.len(), "state"),
                    list(&c.k),
                    gain(c.n),
                    list(&c.l),
                )
            }
        }
    }

    fn step(&self, found: &TunedLoop) -> String {
        let plant = &self.tuned.plant;
        let span = span(found, plant);
        let (mut highest, mut command) = (0.0f64, 0.0f64);
        let mut reached = [0.1, 0.9].map(|share| (share, None));
        found.step_while(plant, |sample| {
            highest = highest.max(sample.output);
            command = command.max(sample.command.abs());
            for (share, time) in &mut reached {
                if time.is_none() && sample.output >= *share {
                    *time = Some(sample.time);
                }
            }
            sample.time < span
        });
        let rise = match reached.map(|(_, time)| time) {
            [Some(low), Some(high)] => format!("{} s", significant(high - low, 3)),
            _ => format!("not within {} s", significant(span, 3)),
        };
        format!(
            "  step of 1          rise (10 to 90 %) {rise}, overshoot {} %, largest command {}\n",
            significant(100.0 * (highest - 1.0).max(0.0), 2),
            significant(command, 3)
        )
    }

    /// The report for machines.
    pub(super) fn json(&self) -> Value {
        let Self { plant, goal, tuned } = self;
        let (model, record) = (&plant.model, plant.record.as_ref());
        let list = |values: &[f64]| -> Vec<Value> { values.iter().map(|v| number(*v)).collect() };
        let margins = |m: &Margins| {
            json!({
                "gain": number(m.gain), "phase_deg": number(m.phase_deg), "delay_s": number(m.delay),
                "max_sensitivity": number(m.max_sensitivity), "crossover": number(m.crossover), "stable": m.stable,
            })
        };
        let gains = |gains: &Gains| match gains {
            Gains::Cascade(c) => json!({"kv": c.kv, "kp": c.kp, "ti": c.ti, "tf": c.tf}),
            Gains::Pid(c) => {
                let (b, a) = c.difference_equation(goal.sample_time);
                json!({"kp": c.kp, "ti": c.ti, "td": c.td, "tf": c.tf, "b": b, "a": a})
            }
            Gains::StateFeedback(c) => json!({
                "k": list(&c.k), "k_input": c.k_input, "n": c.n, "l": list(&c.l), "derivatives": c.derivatives,
            }),
        };
        let loops: Vec<Value> = tuned
            .loops
            .iter()
            .map(|found| {
                json!({
                    "kind": found.gains.name(),
                    "bandwidth": number(found.bandwidth),
                    "warning": record.and_then(|record| record.warning(found.bandwidth)),
                    "gains": gains(&found.gains),
                    "margins": margins(&found.margins),
                    "within_2_sigma": found.worst.as_ref().map(margins),
                })
            })
            .collect();
        let refused: Vec<Value> = tuned
            .refused
            .iter()
            .map(|(kind, reason)| json!({"kind": kind, "reason": reason}))
            .collect();
        json!({
            "a": list(&model.a), "b": list(&model.b), "delay_s": number(model.delay),
            "sample_time": number(goal.sample_time),
            "record": record.map(OfRecord::json),
            "loops": loops, "refused": refused, "feedforward": list(&tuned.feedforward),
        })
    }
}

/// A PID controller by its gains, as it is simulated, and as a difference equation.
///
/// The coefficients of that are differences of nearly equal numbers: those of u add up to one, and
/// those of e to the integral gain of the slower pole, which is what is left. They are printed to
/// the place at which these sums have their digits.
fn pid(c: &Pid, dt: f64) -> String {
    let (b, a) = c.difference_equation(dt);
    let to_place = |value: f64, sum: f64| {
        let more = value.abs().log10().floor() - sum.abs().log10().floor();
        significant(value, (DIGITS as f64 + more.max(0.0)) as usize)
    };
    let beta = a[1];
    let [u1, u2] = [-a[0], -a[1]].map(|v| to_place(v, 1.0 - beta));
    let [e, e1, e2] = b.map(|v| to_place(v, c.kp * dt / c.ti * (1.0 - beta)));
    let integral = gain(c.kp * dt / c.ti);
    if c.td == 0.0 {
        return format!(
            "  kp = {}, ti = {} s; parallel ki = {} 1/s\n  \
             e = r - y; u = kp e + I; I += {integral} e; or u = u1 + {e} e + {e1} e1\n",
            gain(c.kp),
            gain(c.ti),
            gain(c.kp / c.ti),
        );
    }
    format!(
        "  kp = {}, ti = {} s, td = {} s, tf = {} s; parallel ki = {} 1/s, kd = {} s\n  \
         e = r - y; d = {} d + {} (y1 - y); u = kp e + I + d; I += {integral} e\n  \
         or, the derivative that of e: u = {u1} u1 + {u2} u2 + {e} e + {e1} e1 + {e2} e2\n",
        gain(c.kp),
        gain(c.ti),
        gain(c.td),
        gain(c.tf),
        gain(c.kp / c.ti),
        gain(c.kp * c.td),
        gain(beta),
        gain(c.kp * c.td / (c.tf + dt)),
    )
}

/// Bandwidths, as times, that a step is shown over: where it rises, and where it is slow.
const SHOWN: [f64; 2] = [15.0, 1000.0];

/// What is shown after the rise, in units of the time up to it.
const BEHIND: f64 = 3.0;

/// The longest step \[samples\].
const LONGEST: f64 = 2e6;

/// Seconds that show a step, its rise included.
pub(super) fn span(found: &TunedLoop, plant: &SampledPlant) -> f64 {
    let most = LONGEST * plant.sample_time();
    let [shortest, longest] = SHOWN.map(|times| (times / found.bandwidth).min(most));
    let mut end = longest;
    found.step_while(plant, |sample| {
        if sample.output >= 0.9 {
            end = (BEHIND * sample.time).clamp(shortest, longest);
        }
        sample.time < longest && sample.output < 0.9
    });
    end
}

fn title(gains: &Gains) -> &'static str {
    match gains {
        Gains::Cascade(_) => "cascade, position P around velocity PI",
        Gains::Pid(c) if c.td == 0.0 => "PI",
        Gains::Pid(_) => "PID, derivative of the output filtered",
        Gains::StateFeedback(_) => "state feedback with observer",
    }
}
