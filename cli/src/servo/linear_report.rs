//! Output of `trendid demo --linear`: the course of the parameters beside their truth.

use serde_json::{Value, json};
use trendid::trends::Scheme;
use trendid_host_tests::plants::servo::REFERENCE;
use trendid_identify::Choice;
use trendid_identify::dynamic::Recursion;

use super::linear_args::LinearArgs;
use crate::format::{percent, significant, table, transfer_function};
use crate::output::{number, number32};
use crate::plot::{COLOURS, Curve, Figure, GREY, Panel};

/// An estimate is settled when C, w0 and xi all stay this near to the truth.
const SETTLED: f64 = 0.05;

/// One quantity of the model and its course.
pub(super) struct Course {
    name: &'static str,
    unit: &'static str,
    truth: f64,
    /// Time in s, estimate, standard deviation.
    rows: Vec<(f64, f64, f64)>,
}

/// No course yet.
pub(super) fn courses() -> Vec<Course> {
    let [_, a1, a2] = REFERENCE.a();
    [
        ("a1", "1/s^2", a1),
        ("a2", "1/s", a2),
        ("b0", "mm/s^3", REFERENCE.b0()),
        ("C", "mm/s", REFERENCE.c),
        ("w0", "rad/s", REFERENCE.omega0),
        ("xi", "", REFERENCE.xi),
    ]
    .map(|(name, unit, truth)| Course {
        name,
        unit,
        truth,
        rows: Vec::new(),
    })
    .into()
}

/// Appends the estimate at a time.
pub(super) fn note(courses: &mut [Course], core: &dyn Recursion, t: f64) {
    let now = core.estimate();
    let physical = [now.reading.gain, now.reading.omega0, now.reading.damping];
    for (j, course) in courses.iter_mut().enumerate() {
        let (value, sigma) = match j.checked_sub(3) {
            None => (Some(now.theta[j]), Some(now.sigma[j])),
            Some(p) => (physical[p], now.reading_sigma.map(|s| s[p])),
        };
        let known = |v: Option<f64>| v.unwrap_or(f64::NAN);
        course.rows.push((t, known(value), known(sigma)));
    }
}

/// Time after which C, w0 and xi all stay within [`SETTLED`] of the truth.
fn settling_time(courses: &[Course]) -> Option<f64> {
    let physical = &courses[3..];
    let good = |k: usize| {
        physical
            .iter()
            .all(|c| (c.rows[k].1 / c.truth - 1.0).abs() <= SETTLED)
    };
    let rows = physical[0].rows.len();
    let first = (0..rows).rev().take_while(|&k| good(k)).last()?;
    Some(physical[0].rows[first].0)
}

/// The report for people.
pub(super) fn text(courses: &[Course], core: &dyn Recursion, args: &LinearArgs) -> String {
    let noise = &args.noise;
    let trends = match args.filter {
        Choice::Auto => "the default for a bandwidth of about 20 rad/s".into(),
        Choice::Given(Some(pole)) => format!("trends through 1/(s + {pole})^3"),
        Choice::Given(None) => "raw trends".into(),
    };
    let scheme: Scheme = args.scheme.into();
    let mut text = format!(
        "A servo drive simulated at 1 kHz for {} s; position with {} um of white noise, {} um of drift, {} um of resolution (seed {}).\n\
         Identified sample by sample by the no_std core in f32: {scheme:?}, {trends}.\n\n",
        noise.seconds, noise.eta, noise.w, noise.eps, noise.seed
    );
    text += &transients(courses);
    text += &format!("\nAt the end:\n{}", final_values(courses));
    text +=
        "  sigma counts white noise; drift and the sampling itself (about 0.01 %) come on top\n";
    let end = core.estimate();
    text += &format!("\n  G(s) = {}\n", transfer_function(&end.b[0], &end.a, 0.0));
    text += &match settling_time(courses) {
        Some(t) => format!(
            "  C, w0 and xi stay within 5 % of the truth from {:.0} ms on\n",
            1e3 * t
        ),
        None => "  C, w0 and xi never stay within 5 % of the truth\n".into(),
    };
    text
}

/// The course at a few times, and the truth.
fn transients(courses: &[Course]) -> String {
    let mut rows = vec![vec!["t [s]".to_owned()]];
    rows[0].extend(courses.iter().map(|c| c.name.to_owned()));
    let course_rows = courses[0].rows.len();
    for t in [0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0] {
        let Some(k) = courses[0].rows.iter().position(|r| r.0 >= t - 1e-9) else {
            continue;
        };
        if k + 1 < course_rows {
            let mut row = vec![significant(t, 2)];
            row.extend(courses.iter().map(|c| significant(c.rows[k].1, 4)));
            rows.push(row);
        }
    }
    let mut last = vec!["truth".to_owned()];
    last.extend(courses.iter().map(|c| significant(c.truth, 4)));
    rows.push(last);
    table(&rows)
}

/// Truth and estimate at the end.
fn final_values(courses: &[Course]) -> String {
    let mut rows = vec![
        ["", "truth", "estimate", "sigma", "error", "error/sigma"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for c in courses {
        let Some(&(_, value, sigma)) = c.rows.last() else {
            continue;
        };
        let name = if c.unit.is_empty() {
            c.name.to_owned()
        } else {
            format!("{} [{}]", c.name, c.unit)
        };
        rows.push(vec![
            name,
            significant(c.truth, 6),
            significant(value, 6),
            significant(sigma, 2),
            percent(value, c.truth),
            format!("{:+.1}", (value - c.truth) / sigma),
        ]);
    }
    table(&rows)
}

/// The report for machines.
pub(super) fn json_of(courses: &[Course], core: &dyn Recursion) -> Value {
    let mut parameters = serde_json::Map::new();
    for c in courses {
        let (value, sigma) = c.rows.last().map_or((f64::NAN, f64::NAN), |r| (r.1, r.2));
        parameters.insert(
            c.name.into(),
            json!({
                "truth": number(c.truth),
                "estimate": number32(value as f32),
                "sigma": number32(sigma as f32),
                "error_pct": number(100.0 * (value / c.truth - 1.0)),
            }),
        );
    }
    let errors = core.prediction_error();
    json!({
        "parameters": parameters,
        "tss_ms": settling_time(courses).map(|t| number(1e3 * t)),
        "ise": number32(errors.ise()),
        "iae": number32(errors.iae()),
        "samples": errors.samples(),
    })
}

/// How long the first panel of the picture looks at the start, in s.
const START: f64 = 0.25;

/// The picture.
pub(super) fn figure(courses: &[Course], args: &LinearArgs) -> Figure {
    let panel = |title: &str, courses: &[Course], until: f64, half: f64| {
        let rows = |c: &Course| -> Vec<(f64, f64, f64)> {
            c.rows
                .iter()
                .copied()
                .take_while(|r| r.0 <= until)
                .collect()
        };
        let end = rows(&courses[0]).last().map_or(1.0, |r| r.0);
        let mut curves = vec![Curve::new("truth", GREY, vec![(0.0, 1.0), (end, 1.0)])];
        for (c, colour) in courses.iter().zip(COLOURS) {
            let rows = rows(c);
            let points = rows.iter().map(|r| (r.0, r.1 / c.truth)).collect();
            let mut curve = Curve::new(c.name, colour, points);
            let edge =
                |r: &(f64, f64, f64)| ((r.1 - 2.0 * r.2) / c.truth, (r.1 + 2.0 * r.2) / c.truth);
            curve.band = Some(rows.iter().map(edge).collect());
            curves.push(curve);
        }
        Panel {
            title: title.into(),
            x: "t [s]".into(),
            y: "estimate / truth".into(),
            curves,
            range: Some(1.0 - half..1.0 + half),
        }
    };
    let n = &args.noise;
    let trends = match args.filter {
        Choice::Auto => "the default".into(),
        Choice::Given(Some(pole)) => format!("filter poles {pole} rad/s"),
        Choice::Given(None) => "raw trends".into(),
    };
    let titles = [
        "coefficients of the transfer function, the start",
        "velocity gain, natural frequency and damping, the whole run",
    ];
    Figure {
        title: format!(
            "Estimate over truth, band +-2 sigma; w = {}, eta = {}, eps = {} um, {trends}",
            n.w, n.eta, n.eps
        ),
        panels: vec![
            panel(titles[0], &courses[..3], START, 1.0),
            panel(titles[1], &courses[3..], f64::INFINITY, 0.02),
        ],
    }
}
