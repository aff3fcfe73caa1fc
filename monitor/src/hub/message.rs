//! What a page is told, as JSON.

use std::fmt::Write;
use std::path::Path;

use serde_json::{Value, json};
use trendid_link::telemetry::settings::SETTINGS;
use trendid_link::telemetry::{
    Event, Health, Identity, Learned, Losses, NumberedEvent, Sample, SettingValue, reason_of,
    state_of,
};

use crate::hub::reading::reading;
use crate::hub::said::Tally;

/// Rows of samples: tick, position, setpoint, velocity, velocity of the setpoint, command,
/// innovation, state, reason.
pub(super) fn rows<'a>(samples: impl Iterator<Item = &'a Sample>) -> String {
    let mut text = String::from("{\"t\":\"rows\",\"v\":[");
    let mut first = true;
    for sample in samples {
        let Sample {
            tick,
            position,
            setpoint: [r, v],
            velocity,
            command,
            state,
            reason,
            ..
        } = *sample;
        let comma = if first { "" } else { "," };
        first = false;
        // Writing into a string cannot fail; the shortest digits give the same f32 again.
        let _ = write!(text, "{comma}[{tick}");
        let innovation = sample.innovation.unwrap_or(f32::NAN);
        for number in [position, r, velocity, v, command, innovation] {
            // JSON has no other numbers, and another program than ours may send some.
            let _ = match number.is_finite() {
                true => write!(text, ",{number}"),
                false => write!(text, ",null"),
            };
        }
        let _ = write!(text, ",{state},{reason}]");
    }
    text.push_str("]}");
    text
}

pub(super) fn learned(learned: &Learned) -> String {
    let band = |place: usize| {
        let variance = learned.covariance.map(|p| f64::from(p[place]))?;
        Some(2.0 * variance.max(0.0).sqrt())
    };
    json!({
        "t": "learned",
        "tick": learned.tick,
        "theta": shortest(&learned.theta),
        "band": [band(0), band(1), band(2)],
        "reading": reading(learned),
        "model": shortest(&learned.model),
        "expected": learned.expected.map(|e| shortest(&[e])[0].clone()),
        "accepted": learned.counts[0],
        "refused": learned.counts[1],
        "refusal": reason_of(learned.refusal).map(|r| r.to_string()),
        "reversed": learned.reversed,
        "delay": learned.delay,
        "derating": learned.derating,
        "margins": learned.margins,
    })
    .to_string()
}

/// Numbers of f32 with their own digits, not those of the f64 beside them.
fn shortest(values: &[f32]) -> Vec<Value> {
    let own = |x: &f32| {
        x.to_string()
            .parse::<f64>()
            .map_or(Value::Null, Value::from)
    };
    values.iter().map(own).collect()
}

pub(super) fn health(health: &Health) -> String {
    json!({
        "t": "health",
        "tick": health.tick,
        "counters": {
            "failed readings": health.failed_readings,
            "implausible readings": health.implausible_readings,
            "samples at full command": health.saturated_samples,
            "oscillations noticed": health.oscillations,
            "stops by a fault": health.stops,
            "moves at rest": health.moves_at_rest,
            "slots not in time": health.overruns,
            "longest slot [us]": health.longest_us,
            "samples dropped": health.dropped,
            "events lost": health.events_lost,
            "damaged frames at the target": health.corrupt,
        },
    })
    .to_string()
}

/// What happened, in words, and how grave it is.
pub(super) fn words(event: &Event) -> (String, &'static str) {
    match event {
        Event::Start { cause, starts } => (format!("start {starts}: {cause}"), "note"),
        Event::State { state, reason } => match state_of(*state, *reason) {
            Some(state) => {
                let grave = match state.code() {
                    7 => "fault",
                    6 => "warn",
                    _ => "note",
                };
                (state.to_string(), grave)
            }
            None => (format!("state {state}, reason {reason}"), "warn"),
        },
        Event::Model([a1, a2, b0, dead_zone, offset, friction]) => (
            format!(
                "a model reached the controller: a1 {a1:.1}, a2 {a2:.2}, b0 {b0:.0}, dead zone {dead_zone:.4}, offset {offset:.4}, friction {friction:.1}"
            ),
            "good",
        ),
        Event::Refused(reason) => match reason_of(*reason) {
            Some(reason) => (format!("a candidate was refused: {reason}"), "warn"),
            None => ("a candidate was refused".into(), "warn"),
        },
        Event::Fault(what) => (format!("fault: {what}"), "fault"),
        Event::LineLost => (
            "the watchdog of the line has stopped the machine".into(),
            "fault",
        ),
        Event::Overrun => ("a slot was not done in time".into(), "warn"),
    }
}

pub(super) fn event(event: &NumberedEvent) -> String {
    let (said, grave) = words(&event.event);
    let mut value = json!({
        "t": "event",
        "start": event.start,
        "number": event.number,
        "tick": event.tick,
        "words": said,
        "grave": grave,
    });
    match event.event {
        Event::State { state, reason } => {
            value["state"] = state.into();
            value["reason"] = reason.into();
        }
        Event::Start { .. } => value["begin"] = true.into(),
        _ => {}
    }
    value.to_string()
}

/// The answer to a message of a page.
pub(super) fn answer(asked: &str, outcome: Result<(), &str>) -> String {
    let asked: Value = serde_json::from_str(asked).unwrap_or(Value::Null);
    json!({
        "t": "answer",
        "asked": asked,
        "done": outcome.is_ok(),
        "why": outcome.err().unwrap_or_default(),
    })
    .to_string()
}

pub(super) fn setting(value: &SettingValue) -> String {
    let name = SETTINGS
        .get(usize::from(value.setting))
        .map_or("", |setting| setting.name);
    json!({"t": "setting", "name": name, "value": own(value.value)}).to_string()
}

fn own(value: Option<f32>) -> Option<Value> {
    value.map(|value| shortest(&[value])[0].clone())
}

pub(super) fn control(yours: bool, taken: bool, pages: usize) -> String {
    json!({"t": "control", "yours": yours, "taken": taken, "pages": pages}).to_string()
}

pub(super) fn missed(messages: u64) -> String {
    json!({"t": "missed", "messages": messages}).to_string()
}

pub(super) fn record(on: bool, path: &Path, rows: u64, why: &str) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy());
    json!({
        "t": "record",
        "on": on,
        "path": path.display().to_string(),
        "name": name,
        "rows": rows,
        "why": why,
    })
    .to_string()
}

pub(super) fn line(
    up: bool,
    words: &str,
    (rate, silent): (u64, bool),
    tally: &Tally,
    losses: Losses,
    recorded: Option<u64>,
) -> String {
    json!({
        "t": "line",
        "up": up,
        "words": words,
        "rate": rate,
        "silent": silent,
        "samples": tally.samples,
        "missing": tally.missing,
        "dropped": tally.dropped,
        "lost": losses.lost, "corrupt": losses.corrupt,
        "unanswered": losses.unanswered,
        "recorded": recorded,
    })
    .to_string()
}

pub(super) fn hello(identity: Option<&Identity>, values: &[Option<f32>]) -> String {
    let settings: Vec<Value> = SETTINGS
        .iter()
        .zip(values)
        .map(|(setting, value)| {
            json!({
                "name": setting.name,
                "unit": setting.unit,
                "limits": shortest(&setting.limits),
                "follows": setting.follows,
                "value": own(*value),
            })
        })
        .collect();
    let machine = identity.map(|identity| {
        json!({
            "name": identity.name.as_str(),
            "unit": identity.unit.as_str(),
            "dt": shortest(&[identity.sample_time])[0],
            "travel": shortest(&identity.travel),
            "simulated": identity.simulated,
        })
    });
    let states: Vec<String> = (0..8)
        .filter_map(|state| state_of(state, 0))
        .map(|state| {
            let words = state.to_string();
            words.split(':').next().unwrap_or_default().to_owned()
        })
        .collect();
    let reasons: Vec<String> = (0..=u8::MAX)
        .map_while(reason_of)
        .map(|reason| reason.to_string())
        .collect();
    json!({
        "t": "hello",
        "machine": machine,
        "settings": settings,
        "states": states,
        "reasons": reasons,
    })
    .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_keeps_its_bits() {
        for bits in (0..0x7f80_0000_u32).step_by(9_999_991) {
            let position = f32::from_bits(bits);
            let sample = Sample {
                position,
                command: -position,
                ..Sample::default()
            };
            let value: Value = serde_json::from_str(&rows([sample].iter())).unwrap();
            let back = value["v"][0][1].as_f64().unwrap() as f32;
            assert_eq!(back.to_bits(), bits);
            assert_eq!(value["v"][0][5].as_f64().unwrap() as f32, -position);
            assert!(value["v"][0][6].is_null());
        }
        for position in [f32::NAN, f32::INFINITY] {
            let sample = Sample {
                position,
                ..Sample::default()
            };
            let value: Value = serde_json::from_str(&rows([sample].iter())).unwrap();
            assert!(value["v"][0][1].is_null() && value["v"][0][2] == 0.0);
        }
    }
}
