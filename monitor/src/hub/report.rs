//! The report: model, figures and pictures as one page without scripts.

use std::collections::VecDeque;
use std::fmt::Write;

use trendid_link::telemetry::{Health, Identity, Learned, NumberedEvent, Sample, state_of};

use crate::hub::message::words;
use crate::hub::reading::reading;

/// Points of a picture.
const POINTS: usize = 900;

/// Width and height of a picture.
const SIZE: [f64; 2] = [900.0, 180.0];

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1b1f24;background:#fff}\
table{border-collapse:collapse;margin:.5rem 0 1.2rem}td,th{padding:.2rem .8rem .2rem 0;text-align:left;border-bottom:1px solid #d9dde2;font-variant-numeric:tabular-nums}\
svg{width:100%;height:auto;display:block;margin:.2rem 0 1rem}h2{font-size:1.05rem;margin:1.4rem 0 .3rem}.note{color:#4a525c}";

/// The page.
pub(super) fn page(
    identity: Option<&Identity>,
    source: Option<&str>,
    samples: &[&Sample],
    learned: Option<&Learned>,
    health: &Health,
    events: &VecDeque<NumberedEvent>,
) -> String {
    let unknown = Identity::default();
    let identity = identity.unwrap_or(&unknown);
    let name = escape(&identity.name);
    let mut text = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><link rel=\"icon\" href=\"data:,\"><title>Report: {name}</title><style>{STYLE}</style></head><body><main><h1>{name}</h1>"
    );
    // Writing into a string cannot fail.
    let _ = write!(
        text,
        "<p class=\"note\">{}. Sample time {} s, travel {} to {} {unit}.",
        escape(source.unwrap_or("the line is lost")),
        identity.sample_time,
        identity.travel[0],
        identity.travel[1],
        unit = escape(&identity.unit),
    );
    if let Some(last) = samples.last() {
        let state = state_of(last.state, last.reason);
        let state = state.map_or("unknown".into(), |state| state.to_string());
        let _ = write!(text, " State: {}.", escape(&state));
    }
    text.push_str("</p>");
    if let Some(learned) = learned {
        model(&mut text, learned, &identity.unit);
    }
    pictures(&mut text, identity, samples);
    text.push_str("<h2>Counters</h2><table>");
    for (name, value) in [
        ("failed readings", health.failed_readings),
        ("implausible readings", health.implausible_readings),
        ("samples at full command", health.saturated_samples),
        ("oscillations noticed", health.oscillations),
        ("stops by a fault", health.stops),
        ("moves at rest", health.moves_at_rest),
        ("slots not in time", health.overruns),
        ("samples dropped", health.dropped),
    ] {
        let _ = write!(text, "<tr><td>{name}</td><td>{value}</td></tr>");
    }
    text.push_str("</table><h2>Events</h2><table><tr><th>t [s]</th><th>what</th></tr>");
    for event in events.iter().rev().take(100) {
        let t = f64::from(event.tick) * f64::from(identity.sample_time);
        let (said, _) = words(&event.event);
        let _ = write!(text, "<tr><td>{t:.3}</td><td>{}</td></tr>", escape(&said));
    }
    text.push_str("</table></main></body></html>");
    text
}

fn model(text: &mut String, learned: &Learned, unit: &str) {
    let unit = escape(unit);
    let [a1, a2, b0, dead_zone, offset, friction] = learned.model;
    let _ = write!(
        text,
        "<h2>Model in the controller</h2><p>x''' = &minus;{a1} x' &minus; {a2} x'' + {b0} (q(u) + {offset}), dead zone {dead_zone}, friction {friction} {unit}/s&sup2;, delay {} s{}</p>",
        learned.delay,
        if learned.reversed {
            ", valve reversed"
        } else {
            ""
        },
    );
    let _ = write!(
        text,
        "<h2>Estimate</h2><table><tr><th>parameter</th><th>value</th><th>two standard deviations</th></tr>"
    );
    let band = |place: usize| {
        let variance = learned.covariance.map(|p| p[place].max(0.0));
        variance.map_or("unknown".into(), |v| format!("{:.3e}", 2.0 * v.sqrt()))
    };
    for (place, name) in ["a1 [1/s&sup2;]", "a2 [1/s]", "b0"].into_iter().enumerate() {
        let value = learned.theta[place];
        let _ = write!(
            text,
            "<tr><td>{name}</td><td>{value}</td><td>{}</td></tr>",
            band(place)
        );
    }
    if let Some(reading) = reading(learned) {
        let names = [
            format!("C [{unit}/s]"),
            "&omega;0 [rad/s]".into(),
            "&xi;".into(),
        ];
        for (name, [value, band]) in names.iter().zip(reading) {
            let _ = write!(
                text,
                "<tr><td>{name}</td><td>{value:.5}</td><td>{band:.3e}</td></tr>"
            );
        }
    }
    text.push_str("</table>");
    if let Some([gain, phase, delay, sensitivity]) = learned.margins {
        let _ = write!(
            text,
            "<p>Gain margin {gain:.2}, phase margin {phase:.1}&deg;, delay margin {:.2} ms, largest sensitivity {sensitivity:.2}.</p>",
            1e3 * delay
        );
    }
}

fn pictures(text: &mut String, identity: &Identity, samples: &[&Sample]) {
    let dt = f64::from(identity.sample_time);
    let unit = escape(&identity.unit);
    let position = |s: &Sample| f64::from(s.position);
    let setpoint = |s: &Sample| f64::from(s.setpoint[0]);
    let error = |s: &Sample| setpoint(s) - position(s);
    let command = |s: &Sample| f64::from(s.command);
    picture(
        text,
        dt,
        samples,
        &format!("Position and setpoint (dashed) [{unit}]"),
        &[&position, &setpoint],
    );
    picture(text, dt, samples, &format!("Error [{unit}]"), &[&error]);
    picture(text, dt, samples, "Command", &[&command]);
}

/// Lines over time: the extremes of each column of pixels.
fn picture(
    text: &mut String,
    dt: f64,
    samples: &[&Sample],
    title: &str,
    signals: &[&dyn Fn(&Sample) -> f64],
) {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    let [width, height] = SIZE;
    let values = || {
        signals
            .iter()
            .flat_map(|f| samples.iter().map(move |s| f(s)))
    };
    let low = values().fold(f64::INFINITY, f64::min);
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    let span = (high - low).max(1e-9);
    let y = |value: f64| height - 22.0 - (value - low) / span * (height - 34.0);
    let _ = write!(
        text,
        "<h2>{title}</h2><svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\"><rect width=\"{width}\" height=\"{}\" fill=\"#f6f7f9\"/>",
        height - 16.0
    );
    for (signal, (colour, dash)) in signals
        .iter()
        .zip([("#0b5cad", "none"), ("#a8480a", "6 4")])
    {
        let mut points = String::new();
        let part = samples.len().div_ceil(POINTS / 2).max(1);
        for (place, chunk) in samples.chunks(part).enumerate() {
            let x = width * (place * part) as f64 / samples.len() as f64;
            let low = chunk
                .iter()
                .map(|s| signal(s))
                .fold(f64::INFINITY, f64::min);
            let high = chunk
                .iter()
                .map(|s| signal(s))
                .fold(f64::NEG_INFINITY, f64::max);
            let _ = write!(points, "{x:.1},{:.1} {x:.1},{:.1} ", y(low), y(high));
        }
        let _ = write!(
            text,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.4\" stroke-dasharray=\"{dash}\"/>"
        );
    }
    let t = |tick: u32| f64::from(tick) * dt;
    let _ = write!(
        text,
        "<g font-size=\"12\" fill=\"#30363d\"><text x=\"4\" y=\"14\">{high:.4}</text><text x=\"4\" y=\"{:.0}\">{low:.4}</text><text x=\"60\" y=\"{:.0}\">{:.2} s</text><text x=\"{width}\" y=\"{:.0}\" text-anchor=\"end\">{:.2} s</text></g></svg>",
        height - 24.0,
        height - 3.0,
        t(first.tick),
        height - 3.0,
        t(last.tick),
    );
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
