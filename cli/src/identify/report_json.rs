//! Output of `trendid identify --json`.

use serde_json::{Value, json};
use trendid_identify::derived::Quantity;
use trendid_identify::poor_input::PoorInput;
use trendid_identify::{Friction, Way};

use crate::identify::report::Report;
use crate::output::number;

impl Report<'_> {
    /// The report for machines.
    pub(super) fn json(&self) -> Value {
        let (p, e) = (self.problem, &self.found.estimate);
        let list = |v: &[f64]| Value::Array(v.iter().map(|x| number(*x)).collect());
        let columns = p.signals.inputs.iter().zip(&e.b);
        let mut inputs: Vec<Value> = columns
            .map(|(input, b)| json!({"name": input.name, "b": list(b)}))
            .collect();
        if p.structure.constant {
            inputs.push(json!({"name": "1", "b": [number(e.constant)]}));
        }
        let [x0, x0c] = self.fits();
        let (found, errors) = (self.found, self.found.errors);
        let least_squares = found.least_squares.as_ref();
        let predicted = |sum: f64| match self.diverged() {
            true => Value::Null,
            false => number(sum),
        };
        json!({
            "a": list(&e.a),
            "inputs": inputs,
            "sigma": list(&e.sigma),
            "parameters": p.parameter_names(),
            "delay_s": number(self.delay_s()),
            "delay_sigma_s": found.delay_sigma().map(|sigma| number(sigma * p.signals.dt)),
            "delay_missed_s": found.delay_missed().map(|both| list(&both.map(|d| d * p.signals.dt))),
            "delay_untold": found.delay_untold(),
            "delay_at_end": found.delay_at_end,
            "friction": match found.friction {
                Friction::Measured => "measured",
                Friction::Held => "of the model",
                Friction::HeldAtRest => "of the model, also at rest",
            },
            "delay_alike": found.delay_alike,
            "delay_imitated": found.delay_imitated.map(number),
            "poor_input": found.poor_input.map(PoorInput::name),
            "method": self.method(),
            "least_squares": least_squares.map(|e| json!({"theta": list(&e.theta), "sigma": list(&e.sigma)})),
            "effective_blocks": found.effective_blocks.map(number),
            "standstill_s": number(self.standstill_s()),
            "verdict": self.verdict(),
            "filter_pole": found.pole.map(number),
            "filter": found.own_filter,
            "filter_shifts": found.filter_shifts.map(|shifts| list(&shifts)),
            "fit_pct": number(x0),
            "fit_x0c_pct": number(x0c),
            "fit_held_out": self.found.held_out,
            "remarks": self.remarks(),
            "ise": predicted(errors.ise),
            "iae": predicted(errors.iae),
            "samples": p.samples(),
            "jitter": self.notes.resampling.jitter.map(number),
            "filled": self.notes.resampling.filled,
            "clock": self.notes.clock.map(number),
            "granted": self.notes.granted,
            "alone": self.notes.alone_json(),
            "dead_zone": self.dead_zone.map(|z| json!({"half_width": number(z.half_width), "centre": number(z.centre)})),
            "physical": self.physical_json(),
        })
    }

    fn method(&self) -> &'static str {
        match self.found.way {
            Way::Instruments => "instruments",
            Way::OutputError => "output error",
            Way::WeakInstruments => "least squares",
            Way::Recursion => "recursion",
        }
    }

    fn physical_json(&self) -> Value {
        let some = |v: Option<f64>| v.map_or(Value::Null, number);
        let (p, e) = (self.problem, &self.found.estimate);
        let r = &e.reading;
        let time_constants = p.time_constants(e);
        let numbers = |of: fn(&Quantity) -> f64| -> Vec<Value> {
            time_constants.iter().map(|q| number(of(q))).collect()
        };
        let mut physical = json!({
            "gain": some(r.gain),
            "omega0": some(r.omega0),
            "damping": some(r.damping),
            "time_constants_s": numbers(|q| q.value),
            "poles": r.poles.as_ref().map(|p| p.iter().map(|(re, im)| [*re, *im]).collect::<Vec<_>>()),
            "stable": r.stable,
        });
        let mut sigma = json!({"time_constants_s": numbers(|q| q.sigma)});
        for (k, (name, value)) in [
            ("gain", r.gain),
            ("omega0", r.omega0),
            ("damping", r.damping),
        ]
        .into_iter()
        .enumerate()
        {
            sigma[name] = some(value.and_then(|_| self.reading_sigma(k)));
        }
        let poles = p.poles(e);
        let each = |of: fn(&Quantity) -> f64| -> Vec<Value> {
            let pair = |(re, im): &(Quantity, Quantity)| json!([number(of(re)), number(of(im))]);
            poles.iter().map(pair).collect()
        };
        sigma["poles"] = json!(each(|q| q.sigma));
        for (name, q) in p.force_balance(e) {
            physical[name] = number(q.value);
            sigma[name] = number(q.sigma);
        }
        if let Some(q) = p.dead_zone(e) {
            physical["dead_zone"] = number(q.value);
            sigma["dead_zone"] = number(q.sigma);
        }
        for (name, q) in self.further_gains() {
            physical["further_gains"][name] = number(q.value);
            sigma["further_gains"][name] = number(q.sigma);
        }
        physical["sigma"] = sigma;
        physical
    }
}
