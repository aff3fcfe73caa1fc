//! Table 1 for people: every filter, the brief one, and the comparison with the limits.

use std::fmt::Write as _;

use trendid::trends::Scheme;
use trendid_host_tests::paper::statistics::Line;
use trendid_host_tests::paper::trial::{Filter, Method};
use trendid_host_tests::signals::noise::Reading;

use crate::format::{significant, table};
use crate::paper::args::Table1Args;

/// The footnote of every table.
const DEFINITIONS: &str = "\
Errors are relative, in percent, of C, omega0, xi at the end of the record. Plant: b0 / (s (s^2 + 20 s + 400)), b0 = 1e6.
ABSOLUTE: u = binary noise +-0.4 held 50 ms; w, eta, eps as printed in the paper, in um of position. The drift w is
(w/2) sin(2 pi 0.5 Hz t + random phase), eta is uniform and white of full width eta, eps is rounding to multiples of eps.
RELATIVE: u = binary noise +-1 held 40 ms; w, eta, eps scaled together until rms(measured - true position) over the rms
of the true position about its mean is the printed N/S. The drift is uniform white noise of full width w through a lag
of 200 ms; eta and eps as above. The paper does not give its definitions; both are readings of its widths.
Block white: the noise block with eta alone. N/S here: of the records used, by the definition of RELATIVE.
Bound: Cramer-Rao for white noise of the rms of the record and an unknown position at the start. In the rows of drift
and resolution the noise is not white and the figure is a scale, not a bound.
T_ss: first time after which all three errors stay within 5 %. CONV: mean over the last half of the record of
|theta(k) - theta(end)| / |theta(end)|, averaged over a1, a2, b0; not comparable with the paper's column.
Table 2 of the paper suggests that its heads C and xi are swapped; its columns stand here as printed.
Diverged: runs with an error above 100 % or without a reading; one run without a reading makes an rms infinite.
Weak: runs in which the instruments were too weak for a model, and least squares stands in their place and says so.
";

/// Opponents and core, in the words of the legend.
const LEGEND: &str = "\
output-error: fit of the free simulation to the whole record, offline, started 20 % off
ekf: extended Kalman filter of six states that knows the noise level, started 20 % off
instruments: the core's, behind the default filter, at the end of the record
ls: recursive least squares of the core, bare; ls+bias: the core's read-out, noise bias taken out (the default)
filter none: the core works in f32; the third difference of a position in 24 bits rules these rows even without noise
";

fn cell(value: f64) -> String {
    if value.is_infinite() {
        "inf".to_owned()
    } else {
        significant(value, 3)
    }
}

fn triple(values: [f64; 3]) -> String {
    values.map(cell).join(" / ")
}

fn condition(line: &Line) -> String {
    let c = &line.setting.condition;
    format!(
        "{}: w {} um, eta {} um, eps {} um, {} ms",
        line.setting.vary, c.w_um, c.eta_um, c.eps_um, c.dt_ms
    )
}

fn legend() -> String {
    let mut text = String::from(LEGEND);
    for filter in Filter::ALL {
        let _ = writeln!(text, "filter {}: {}", filter.name(), filter.legend());
    }
    text
}

fn seeds(args: &Table1Args) -> String {
    format!(
        "{} records per condition, seeds {}..{}",
        args.seeds,
        args.first_seed,
        args.first_seed + args.seeds
    )
}

/// One line per condition, every filter in its own column.
pub(super) fn markdown(args: &Table1Args, lines: &[Line]) -> String {
    let mut text = String::new();
    for reading in [Reading::Absolute, Reading::Relative] {
        for scheme in [Scheme::Tustin, Scheme::Goodwin] {
            let part: Vec<&Line> = lines
                .iter()
                .filter(|l| l.setting.condition.reading == reading)
                .collect();
            let Some(first) = part.first() else { continue };
            let _ = writeln!(
                text,
                "### {}, {scheme:?}\n\nrms error of C / omega0 / xi \\[%\\] after {} s; {}.\n",
                first.setting.reading().to_uppercase(),
                first.duration_s,
                seeds(args)
            );
            text += "| vary | w, eta, eps \\[um\\] | ms | N/S \\[%\\] | paper | bound | output error | EKF |";
            let shown = shown(scheme);
            for (filter, _) in &shown {
                let _ = write!(text, " {} |", filter.name());
            }
            let instruments = scheme == Scheme::Tustin;
            if instruments {
                text += " instruments |";
            }
            text += " T_ss med, p95 of default \\[ms\\] | diverged |\n|";
            text += &"---|".repeat(10 + shown.len() + usize::from(instruments));
            text.push('\n');
            for group in part.chunk_by(|a, b| a.setting == b.setting) {
                text += &short_row(group, scheme, &shown);
            }
            text.push('\n');
        }
    }
    text += "```text\n";
    text += DEFINITIONS;
    text += &legend();
    text + "Columns default, ramp and exact are the read-outs ls+bias; diverged counts the default.\n```\n"
}

/// One row per condition: paper, bound, opponents and the default of the core.
pub(super) fn brief(args: &Table1Args, lines: &[Line]) -> String {
    let mut text = format!(
        "rms errors of C / omega0 / xi \\[%\\]; {}.\n\n\
         | condition | N/S \\[%\\] | paper, Tustin | extended Kalman filter | trendid | offline fit | Cramér-Rao bound |\n\
         |---|---|---|---|---|---|---|\n",
        seeds(args)
    );
    for group in lines.chunk_by(|a, b| a.setting == b.setting) {
        let first = &group[0];
        let of = |method: Method| {
            let line = group.iter().find(|l| l.method == method);
            line.map_or(String::new(), |l| triple(l.rms_pct))
        };
        let cells = [
            format!(
                "{}, {}, {} s",
                first.setting.reading().to_uppercase(),
                condition(first),
                first.duration_s
            ),
            cell(first.ns_pct),
            triple(first.paper_pct()),
            of(Method::Kalman),
            of(Method::DEFAULT),
            of(Method::OutputError),
            triple(first.bound_pct),
        ];
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    text
}

/// The read-outs that users get: the core's own.
fn shown(scheme: Scheme) -> Vec<(Filter, Method)> {
    let filters = Filter::ALL.into_iter().filter(|f| f.goes_with(scheme));
    filters
        .map(|filter| {
            let compensated = !matches!(filter, Filter::None | Filter::Span);
            (
                filter,
                Method::Core {
                    scheme,
                    filter,
                    compensated,
                },
            )
        })
        .collect()
}

fn short_row(group: &[&Line], scheme: Scheme, shown: &[(Filter, Method)]) -> String {
    let first = group[0];
    let c = &first.setting.condition;
    let printed = first.setting.printed(scheme);
    let of = |method: Method| group.iter().find(|l| l.method == method);
    let rms = |method: Method| of(method).map_or(String::new(), |l| triple(l.rms_pct));
    let mut cells = vec![
        first.setting.vary.to_owned(),
        format!("{}, {}, {}", c.w_um, c.eta_um, c.eps_um),
        c.dt_ms.to_string(),
        cell(first.ns_pct),
        triple([printed.c_pct, printed.omega0_pct, printed.xi_pct]),
        triple(first.bound_pct),
        rms(Method::OutputError),
        rms(Method::Kalman),
    ];
    cells.extend(shown.iter().map(|(_, method)| rms(*method)));
    if scheme == Scheme::Tustin {
        cells.push(rms(Method::Instruments));
    }
    let default = shown
        .iter()
        .find(|(filter, _)| *filter == Filter::Default)
        .and_then(|(_, method)| of(*method));
    if let Some(line) = default {
        let time = |v: Option<f64>| v.map_or(String::new(), |ms| format!("{ms:.0}"));
        cells.push(format!(
            "{}, {}",
            time(line.settled_median_ms),
            time(line.settled_p95_ms)
        ));
        cells.push(line.diverged.to_string());
    }
    format!("| {} |\n", cells.join(" | "))
}

/// Whether the comparison with the limits shows the method: modified Tustin, filtered, the core's
/// own read-out.
pub(super) fn checked(method: Method) -> bool {
    match method {
        Method::Core {
            scheme: Scheme::Tustin,
            filter,
            compensated,
        } => match filter {
            Filter::None => false,
            Filter::Span => true,
            _ => compensated,
        },
        Method::Instruments => true,
        _ => false,
    }
}

/// Whether a line is within its limits, or in which figures it is not.
fn verdict(line: &Line) -> String {
    match line.beyond() {
        None => "-".to_owned(),
        Some([false, false, false]) => "yes".to_owned(),
        Some(beyond) => {
            let names = ["C", "omega0", "xi"];
            let which: Vec<&str> = (0..3).filter(|i| beyond[*i]).map(|i| names[i]).collect();
            format!("no: {}", which.join(" "))
        }
    }
}

/// Every filter behind modified Tustin against the limits, and the rms against the extended Kalman
/// filter.
pub(super) fn check(args: &Table1Args, lines: &[Line]) -> String {
    let head = [
        "reading, condition",
        "filter",
        "rms error [%]",
        "mean error [%]",
        "limit [%]",
        "rms/bound",
        "median/bound",
        "EKF [%]",
        "T_ss p95 [ms]",
        "diverged",
        "weak",
        "within",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for group in lines.chunk_by(|a, b| a.setting == b.setting) {
        let kalman = group.iter().find(|l| l.method == Method::Kalman);
        for line in group {
            let name = match line.method {
                Method::Core { filter, .. } => filter.name(),
                _ => line.method.estimator(),
            };
            if !checked(line.method) {
                continue;
            }
            rows.push(vec![
                format!("{} {}", line.setting.reading(), condition(line)),
                name.to_owned(),
                triple(line.rms_pct),
                triple(line.mean_pct),
                line.limit_pct().map_or(String::new(), triple),
                triple(line.of_bound()),
                triple([0, 1, 2].map(|i| line.median_pct[i] / line.bound_pct[i])),
                kalman.map_or(String::new(), |k| triple(k.rms_pct)),
                line.settled_p95_ms.map_or(String::new(), cell),
                line.diverged.to_string(),
                line.weak.to_string(),
                verdict(line),
            ]);
        }
    }
    let durations: Vec<String> = lines
        .chunk_by(|a, b| a.duration_s == b.duration_s)
        .map(|g| {
            format!(
                "{} s in {}",
                g[0].duration_s,
                g[0].setting.reading().to_uppercase()
            )
        })
        .collect();
    format!(
        "C / omega0 / xi, modified Tustin; {}; {}\n{}{DEFINITIONS}",
        seeds(args),
        durations.join(", "),
        table(&rows)
    )
}
