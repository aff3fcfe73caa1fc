//! `trendid demo --linear`: the core finds the parameters of a simulated servo.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};
use trendid::{FilteredTrends, Hold, Outcome, Scheme, Terms};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, Reading};
use trendid_identify::dynamic::{Filter, InputSetup, Recursion, Setup};

use crate::format::{percent, significant, table, transfer_function};
use crate::identify::signals::SchemeName;
use crate::output::{Refusal, emit, emit_json, number, number32};
use crate::plot::{COLOURS, Curve, Figure, GREY, Panel};
use trendid_identify::Choice;
use trendid_identify::tuning::binomial;

/// Rough design values, all that the identifier is told: rad/s, and mm of movement.
const BANDWIDTH: f64 = 20.0;
const MOVEMENT: f32 = 50.0;
const COMMAND: f32 = 0.4;

/// An estimate is settled when C, w0 and xi all stay this near to the truth.
const SETTLED: f64 = 0.05;

/// Measurement of the simulated position.
#[derive(Debug, Clone, Args)]
pub struct NoiseArgs {
    /// Seed of command and noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Duration [s]
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    pub seconds: f64,
    /// Full width of the white noise of the position [um]
    #[arg(long, value_name = "UM", default_value_t = 20.0)]
    pub eta: f64,
    /// Full width of the slow drift of the position [um]
    #[arg(long, value_name = "UM", default_value_t = 200.0)]
    pub w: f64,
    /// Resolution of the position sensor [um]
    #[arg(long, value_name = "UM", default_value_t = 10.0)]
    pub eps: f64,
}

impl NoiseArgs {
    /// The reference servo under binary noise, measured as asked.
    ///
    /// # Errors
    ///
    /// The first value that makes no sense.
    pub fn record(&self) -> Result<Record, Refusal> {
        for (name, width) in [("eta", self.eta), ("w", self.w), ("eps", self.eps)] {
            if !(width.is_finite() && width >= 0.0) {
                return Err(Refusal::new(format!(
                    "--{name} {width} is not a width of 0 um or more"
                )));
            }
        }
        if !(0.1..=600.0).contains(&self.seconds) {
            return Err(Refusal::new(format!(
                "--seconds {} is not between 0.1 and 600 s",
                self.seconds
            )));
        }
        let condition = Condition {
            w_um: self.w,
            eta_um: self.eta,
            eps_um: self.eps,
            dt_ms: 1.0,
            ns_pct: 0.0,
            reading: Reading::Absolute,
        };
        Ok(Experiment::reference(condition, self.seconds).record(self.seed))
    }
}

/// What the identification is asked to do.
pub struct LinearArgs {
    pub noise: NoiseArgs,
    pub scheme: SchemeName,
    pub filter: Choice<Option<f64>>,
    pub out: PathBuf,
    pub json: bool,
}

/// One quantity of the model and its course.
struct Course {
    name: &'static str,
    unit: &'static str,
    truth: f64,
    /// Time in s, estimate, standard deviation.
    rows: Vec<(f64, f64, f64)>,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on an option that makes no sense or a file that cannot be written.
pub fn run(args: &LinearArgs) -> Result<(), Refusal> {
    let record = args.noise.record()?;
    let mut core = setup(&record, args.scheme.into(), args.filter)?.build()?;
    let mut courses = courses();
    for sample in record.samples() {
        let outcome = core.update(&[sample.u as f32], sample.y as f32);
        if matches!(outcome, Outcome::Estimated { .. }) {
            note(&mut courses, core.as_ref(), sample.t);
        }
    }
    let picture = figure(&courses, args).save(&args.out, "transients")?;
    if args.json {
        let mut value = json_of(&courses, core.as_ref());
        value["pictures"] = json!([picture.display().to_string()]);
        emit_json(&value);
        return Ok(());
    }
    emit(&text(&courses, core.as_ref(), args));
    emit(&format!(
        "\nPicture of the transients: {}\n",
        picture.display()
    ));
    Ok(())
}

/// The default of the core, or a filter of one pole without constant and start.
fn setup(record: &Record, scheme: Scheme, choice: Choice<Option<f64>>) -> Result<Setup, Refusal> {
    let filter = match choice {
        Choice::Auto => {
            let default =
                FilteredTrends::<3>::for_bandwidth(scheme, record.dt as f32, BANDWIDTH as f32)?;
            Filter::Polynomial(default.filter().to_vec())
        }
        Choice::Given(Some(pole)) => Filter::Polynomial(binomial(pole, 3)),
        Choice::Given(None) => Filter::None,
    };
    let default = matches!(choice, Choice::Auto);
    Ok(Setup {
        order: 3,
        output: Terms::between(1, 3),
        inputs: vec![InputSetup {
            terms: Terms::up_to(1),
            hold: Hold::Zero,
            delay: 0,
            range: COMMAND,
            initial: 0.0,
        }],
        constant: default,
        start: default,
        sample_time: record.dt as f32,
        scheme,
        filter,
        bandwidth: BANDWIDTH as f32,
        output_range: MOVEMENT,
        output_noise: 1e-3 * MOVEMENT,
        memory: None,
        settling: 0.0,
    })
}

fn courses() -> Vec<Course> {
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

fn note(courses: &mut [Course], core: &dyn Recursion, t: f64) {
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

fn text(courses: &[Course], core: &dyn Recursion, args: &LinearArgs) -> String {
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
    text += &table(&rows);

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
    text += &format!("\nAt the end:\n{}", table(&rows));
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

fn json_of(courses: &[Course], core: &dyn Recursion) -> Value {
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
    let quality = core.prediction_error();
    json!({
        "parameters": parameters,
        "tss_ms": settling_time(courses).map(|t| number(1e3 * t)),
        "iq": number32(quality.ise()),
        "iv": number32(quality.iae()),
        "samples": quality.samples(),
    })
}

/// How long the first panel of the picture looks at the start, in s.
const START: f64 = 0.25;

fn figure(courses: &[Course], args: &LinearArgs) -> Figure {
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

/// The servo's truth as comment lines of a record.
pub fn truth_lines(servo: &Servo) -> [String; 2] {
    [
        format!(
            "# truth: y(s)/u(s) = {}; a1 = {}, a2 = {}, b0 = {}",
            transfer_function(&[servo.b0()], &servo.a(), 0.0),
            servo.a()[1],
            servo.a()[2],
            servo.b0()
        ),
        format!(
            "# truth: C = {} mm/s per unit, w0 = {} rad/s, xi = {}",
            servo.c, servo.omega0, servo.xi
        ),
    ]
}
