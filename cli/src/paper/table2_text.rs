//! Table 2 as text, CSV and JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};
use trendid::trends::Scheme;

use crate::format::{significant, table};
use crate::output;
use crate::paper::args::Table2Args;
use crate::paper::found::Found;

/// Meaning of the figures.
const DEFINITIONS: &str = "\
G = (b2 s^2 + b1 s + b0) / (s (a3 s^3 + a2 s^2 + a1 s + a0)), all related to a2 = 1 (m = 1: a1 = 1), b in 1e6; medians
over the records +- half the distance of the quartiles. Truth: a1 = 20, a0 = 400, b0 = 1, all else 0.
w = 100 um, eta = 10 um, eps = 10 um, 1 ms; readings as under Table 1.
Parameters: of the recursion at the end of the record; raw: raw trends; filtered: FilteredTrends::for_bandwidth(20 rad/s)
with constant and start. Every structure has the integrator, so the core's order is m + 1.
Both indices are sums (11) of squared errors of the velocity in (m/s)^2, with these parameters over a second record of the
same length.
IQ(10): y^(k) by (10) from raw trends of the same scheme, (y(k) - y^(k))/Delta. An (m+1)-th difference of the noise
enters it and grows with the order, so it cannot judge the order under this noise.
IQ: (y(k) - y(k-1))/Delta minus the same of a free simulation from rest. The noise alone gives 2 (eta^2 + eps^2)/12/Delta^2
per sample, 0.100 in 3 s: the size of the paper's IQ.
With m = 3 and b1 any common factor (s + c) of numerator and denominator fits as well: a3 is not determined.
";

const NAMES: [&str; 6] = ["a3", "a1", "a0", "b2", "b1", "b0"];

fn cell(value: f64) -> String {
    if value.is_nan() {
        "-".to_owned()
    } else {
        significant(value, 4)
    }
}

/// The table for people.
pub(super) fn plain(args: &Table2Args, found: &[Found]) -> String {
    let mut text = format!(
        "{} records of {} s, seeds {}..{}\n",
        args.seeds,
        args.duration,
        args.first_seed,
        args.first_seed + args.seeds
    );
    let mut rows = vec![
        [
            "structure",
            "scheme",
            "",
            "a3",
            "a1",
            "a0",
            "b2",
            "b1",
            "b0",
            "IQ(10)",
            "IQ",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    for group in found.chunks(4) {
        let structure = format!(
            "m = {}, M = {}",
            group[0].size.m,
            group[0].size.m + group[0].size.numerators
        );
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            for (k, f) in group.iter().filter(|f| f.scheme == scheme).enumerate() {
                if k == 0 {
                    let mut paper =
                        vec![structure.clone(), f.scheme().to_owned(), "paper".to_owned()];
                    paper.extend(f.paper().map(cell));
                    rows.push(paper);
                }
                let mut row = vec![String::new(), f.scheme().to_owned(), f.kind().to_owned()];
                row.extend((0..8).map(|i| match f.median[i] {
                    // Given, not estimated.
                    one if f.size.m == 1 && i == 1 => cell(one),
                    none if none.is_nan() => cell(none),
                    value => format!("{} +- {}", cell(value), significant(f.spread[i], 2)),
                }));
                rows.push(row);
            }
        }
    }
    text += &table(&rows);
    let _ = write!(text, "\n{DEFINITIONS}");
    text
}

/// One line per structure and method.
pub(super) fn csv(args: &Table2Args, found: &[Found]) -> String {
    let mut text = String::from("m,M,scheme,filter,reading,duration_s,seeds");
    for name in NAMES {
        let _ = write!(text, ",{name},{name}_spread,paper_{name}");
    }
    text += ",iq10,iq10_spread,paper_iq,iq,iq_spread\n";
    let plain = |v: f64| {
        if v.is_nan() {
            String::new()
        } else {
            format!("{v:.6e}")
        }
    };
    for f in found {
        let _ = write!(
            text,
            "{},{},{},{},{},{},{}",
            f.size.m,
            f.size.m + f.size.numerators,
            f.scheme(),
            f.kind(),
            args.reading.name(),
            args.duration,
            args.seeds
        );
        for i in 0..7 {
            for v in [f.median[i], f.spread[i], f.paper()[i]] {
                let _ = write!(text, ",{}", plain(v));
            }
        }
        let _ = writeln!(text, ",{},{}", plain(f.median[7]), plain(f.spread[7]));
    }
    text
}

/// The same as JSON.
pub(super) fn as_json(args: &Table2Args, found: &[Found]) -> Value {
    let rows: Vec<Value> = found
        .iter()
        .map(|f| {
            let named = |values: &[f64]| -> Value {
                NAMES
                    .iter()
                    .zip(values)
                    .map(|(name, v)| ((*name).to_owned(), output::number(*v)))
                    .collect::<serde_json::Map<_, _>>()
                    .into()
            };
            json!({
                "m": f.size.m, "M": f.size.m + f.size.numerators, "scheme": f.scheme(), "filter": f.kind(),
                "median": named(&f.median), "spread": named(&f.spread), "paper": named(&f.paper()),
                "iq10": output::number(f.median[6]), "iq": output::number(f.median[7]),
                "paper_iq": output::number(f.paper()[6]),
            })
        })
        .collect();
    json!({
        "first_seed": args.first_seed, "seeds": args.seeds, "duration_s": args.duration, "reading": args.reading.name(),
        "definitions": DEFINITIONS, "rows": rows,
    })
}
