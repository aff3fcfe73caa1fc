//! `trendid identify`: the core over a recorded drive.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use crate::auto::{Choice, Freedom, own, tune};
use crate::estimate::{Estimate, Index, Problem, Run, Trace};
use crate::format::{polynomial, significant, table, transfer_function, with_sigma};
use crate::freerun::FreeRun;
use crate::output::{Refusal, emit, emit_json, number, progress};
use crate::plot::{COLOURS, Curve, Figure, PALE, Panel};
use crate::signals::{SignalArgs, Signals, StructureChoice, parse_delay, parse_filter};
use crate::symmetric::eigen;
use crate::tuning::Tuning;

const EXAMPLE: &str = "\
Example (a drive with Coulomb friction, whose record has the columns t, u, y):
  trendid identify emps.csv --order 2 --integrator --coulomb --constant

The model is A(s) y = B(s) u(t - d dt) + c sgn(v) + constant. The fit is
100 (1 - |y - y_sim| / |y - mean|) of a free simulation of the second half with the
model of the first half: `x0` with the initial state refitted, `x0+c` with the
constant refitted too, the fair figure behind an integrator.";

/// Smallest eigenvalue of the correlation of the parameters that f32 can tell from zero.
const SINGULAR: f64 = 1e-6;

/// Below this fit in percent a model says little about the drive.
const POOR: f64 = 50.0;

/// Identify a continuous-time model from a record
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub struct IdentifyArgs {
    #[command(flatten)]
    signals: SignalArgs,
    /// Order of the model, 1 to 4, the integrator included
    #[arg(long, value_name = "M")]
    order: usize,
    /// The plant integrates: a0 = 0
    #[arg(long)]
    integrator: bool,
    /// Number of zeros: b0 .. bK of each input are estimated
    #[arg(long, value_name = "K", default_value_t = 0)]
    zeros: usize,
    /// Delay of the inputs in samples, or the best of 0 to 10
    #[arg(long, value_name = "D|auto", default_value = "0", value_parser = parse_delay)]
    delay: Choice<usize>,
    /// Filter poles in rad/s (1 to 1.5 times the bandwidth of the plant), `auto` (those whose model simulates the record best,
    /// or the poles of that model itself where they do better), or `none` for raw trends
    #[arg(long, value_name = "POLE|auto|none", default_value = "auto", value_parser = parse_filter)]
    filter: Choice<Option<f64>>,
    /// Memory of the estimator; without it nothing is forgotten
    #[arg(long, value_name = "SECONDS")]
    memory: Option<f64>,
    /// Write pictures (SVG and PNG) into this directory
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Everything that is printed.
struct Report<'a> {
    problem: &'a Problem,
    tuning: Tuning,
    estimate: Estimate,
    index: Index,
    free_run: Option<FreeRun>,
    /// Whether the simulated model came from the first half alone.
    held_out: bool,
}

/// Runs the command.
///
/// # Errors
///
/// One sentence on what is wrong with the record or the structure.
pub fn run(args: &IdentifyArgs) -> Result<(), Refusal> {
    let signals = args.signals.load()?;
    let structure = StructureChoice {
        order: args.order,
        integrator: args.integrator,
        zeros: args.zeros,
    };
    let mut problem = args.signals.problem(&signals, structure)?;
    if let Some(memory) = args.memory
        && !(memory.is_finite() && memory > 2.0 * signals.dt)
    {
        return Err(Refusal::new(format!(
            "a memory of {memory} s is not longer than two samples ({} s)",
            2.0 * signals.dt
        )));
    }
    problem.memory = args.memory;

    let bar = progress(0, "choosing filter and delay");
    let freedom = Freedom {
        pole: args.filter,
        delay: args.delay,
    };
    let tuning = match (args.filter, args.delay) {
        (Choice::Given(pole), Choice::Given(delay)) => Tuning {
            pole,
            own: None,
            delay,
        },
        _ => tune(&problem, freedom, &bar)?,
    };
    let tuning = match args.filter {
        Choice::Auto => own(&problem, tuning),
        Choice::Given(_) => tuning,
    };
    bar.finish_and_clear();

    let mut trace = Trace::default();
    let every = (problem.y.len() / 1000).max(1);
    let Run {
        end: estimate,
        index,
        ..
    } = problem.run(tuning, Some((&mut trace, every)))?;
    check(&problem, &estimate)?;
    let half = problem.run_held(tuning)?.half;
    let range = problem.y.len() / 2..problem.y.len();
    let held_out = check(&problem, &half).is_ok();
    let judged = if held_out { &half } else { &estimate };
    let free_run = problem.free_run(judged, tuning.delay, range);
    let report = Report {
        problem: &problem,
        tuning,
        estimate,
        index,
        free_run,
        held_out,
    };

    if args.json {
        emit_json(&report.json());
    } else {
        emit(&report.text(args, &signals));
    }
    if let Some(dir) = &args.plot {
        let mut written = report
            .simulation_figure(&signals)
            .save(dir, "simulation")?
            .to_vec();
        written.extend(
            report
                .transient_figure(&signals, &trace)
                .save(dir, "parameters")?,
        );
        if !args.json {
            let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
            emit(&format!("\nPictures: {}\n", names.join(", ")));
        }
    }
    Ok(())
}

/// Whether the samples told all parameters apart.
pub fn check(problem: &Problem, estimate: &Estimate) -> Result<(), Refusal> {
    let names = problem.parameter_names();
    let cannot = |why: String| {
        Refusal::new(format!(
            "the data cannot carry a model of order {} with {} parameters: {why}",
            problem.order,
            names.len()
        ))
    };
    if !estimate
        .theta
        .iter()
        .chain(&estimate.sigma)
        .all(|v| v.is_finite())
    {
        return Err(cannot("the estimate is not finite".into()));
    }
    if estimate
        .correlation
        .iter()
        .flatten()
        .any(|v| !v.is_finite())
    {
        return Err(cannot("a parameter has no influence on the output".into()));
    }
    let modes = eigen(&estimate.correlation);
    let weakest = modes.iter().min_by(|x, y| x.0.total_cmp(&y.0));
    if let Some((value, direction)) = weakest
        && *value < SINGULAR
    {
        let mixed: Vec<&str> = names
            .iter()
            .zip(direction)
            .filter(|(_, d)| d.abs() > 0.1)
            .map(|(n, _)| n.as_str())
            .collect();
        return Err(cannot(format!("{} cannot be told apart", mixed.join(", "))));
    }
    Ok(())
}

impl Report<'_> {
    fn delay_s(&self) -> f64 {
        self.tuning.delay as f64 * self.problem.dt
    }

    fn fits(&self) -> [f64; 2] {
        self.free_run
            .as_ref()
            .map_or([f64::NAN; 2], |f| [f.fit_x0, f.fit_x0c])
    }

    /// The inverse model of a drive: what a force balance calls its parameters.
    fn force_balance(&self) -> Vec<(&'static str, f64)> {
        let e = &self.estimate;
        let [b] = e.b[0][..] else { return Vec::new() };
        if !(self.problem.integrator && self.problem.order == 2) || b == 0.0 {
            return Vec::new();
        }
        let mut balance = vec![("inertia", 1.0 / b), ("viscous", e.a[1] / b)];
        if let Some(c) = self.problem.inputs.iter().position(|i| i.name == "sgn(v)") {
            balance.push(("coulomb", -e.b[c][0] / b));
        }
        if self.problem.constant {
            balance.push(("offset", -e.constant / b));
        }
        balance
    }

    fn text(&self, args: &IdentifyArgs, signals: &Signals) -> String {
        let (p, e) = (self.problem, &self.estimate);
        let end = signals.start + (p.y.len() - 1) as f64 * p.dt;
        let mut text = format!(
            "{}: {} samples every {} s, t = {} .. {} s\n",
            args.signals.file.display(),
            p.y.len(),
            significant(p.dt, 5),
            significant(signals.start, 6),
            significant(end, 6),
        );
        let filter = match (self.tuning.pole, args.filter) {
            (None, _) => "raw trends".into(),
            (Some(_), Choice::Auto) if let Some(own) = &self.tuning.own => {
                let mut f: Vec<f64> = own.coefficients().iter().copied().map(f64::from).collect();
                f.push(1.0);
                format!(
                    "filter 1/({}), the poles of the model itself (auto)",
                    polynomial(&f)
                )
            }
            (Some(pole), Choice::Auto) => {
                format!("filter poles at -{} rad/s (auto)", significant(pole, 3))
            }
            (Some(pole), _) => format!("filter poles at -{} rad/s", significant(pole, 3)),
        };
        let memory = p
            .memory
            .map_or("no forgetting".into(), |m| format!("memory {m} s"));
        text += &format!(
            "{filter}, delay {} samples, {memory}\n\n",
            self.tuning.delay
        );

        for (input, b) in p.inputs.iter().zip(&e.b) {
            let delay = if input.delayed { self.delay_s() } else { 0.0 };
            text += &format!(
                "  {} / {:<6} = {}\n",
                args.signals.output,
                input.name,
                transfer_function(b, &e.a, delay)
            );
        }
        if p.constant {
            let mut a = e.a.clone();
            a.push(1.0);
            text += &format!(
                "  constant: ({}) {} = .. {} {}\n",
                polynomial(&a),
                args.signals.output,
                if e.constant < 0.0 { '-' } else { '+' },
                significant(e.constant.abs(), 4)
            );
        }
        let mut rows = vec![vec![
            "parameter".into(),
            "value +- standard deviation".into(),
        ]];
        for ((name, value), sigma) in p.parameter_names().iter().zip(&e.theta).zip(&e.sigma) {
            rows.push(vec![name.clone(), with_sigma(*value, *sigma)]);
        }
        text += &format!("\n{}\n", table(&rows));
        text += &table(&self.physical_rows());

        let [x0, x0c] = self.fits();
        let model = if self.held_out {
            "model of the first half"
        } else {
            "model of the whole record, because the first half alone cannot carry the structure"
        };
        text += &match self.free_run {
            Some(_) => format!(
                "\n  free simulation of the second half ({model}):\n  fit {x0:.2} % (x0), {x0c:.2} % (x0+c)\n"
            ),
            None => format!("\n  free simulation of the second half ({model}): it runs away\n"),
        };
        if x0c < POOR {
            text += "  this is poor: the structure may be wrong, see `trendid select`\n";
        }
        text += &format!(
            "  one-step prediction: IQ {}, IV {} over {} samples\n",
            significant(self.index.iq, 4),
            significant(self.index.iv, 4),
            self.index.samples
        );
        text
    }

    fn physical_rows(&self) -> Vec<Vec<String>> {
        let r = &self.estimate.reading;
        let std = self.estimate.physical_std.map(|s| s.map(f64::from));
        let mut rows = Vec::new();
        let mut push = |name: &str, value: Option<f32>, which: usize| {
            if let Some(value) = value {
                let value = f64::from(value);
                let text = match std {
                    Some(std) => with_sigma(value, std[which]),
                    None => significant(value, 4),
                };
                rows.push(vec![name.to_owned(), text]);
            }
        };
        push(
            if self.problem.integrator {
                "velocity gain C"
            } else {
                "static gain K"
            },
            r.gain,
            0,
        );
        push("natural frequency w0 [rad/s]", r.omega0, 1);
        push("damping xi", r.damping, 2);
        for t in &r.time_constants {
            rows.push(vec![
                "time constant [s]".into(),
                significant(f64::from(*t), 4),
            ]);
        }
        for (name, value) in self.force_balance() {
            rows.push(vec![format!("{name} [u]"), significant(value, 4)]);
        }
        rows.push(vec![
            "stable".into(),
            if r.stable { "yes" } else { "no" }.into(),
        ]);
        rows
    }

    fn json(&self) -> Value {
        let e = &self.estimate;
        let list = |v: &[f64]| Value::Array(v.iter().map(|x| number(*x)).collect());
        let mut inputs: Vec<Value> = self
            .problem
            .inputs
            .iter()
            .zip(&e.b)
            .map(|(input, b)| json!({"name": input.name, "b": list(b)}))
            .collect();
        if self.problem.constant {
            inputs.push(json!({"name": "1", "b": [number(e.constant)]}));
        }
        let some = |v: Option<f32>| v.map_or(Value::Null, |v| number(f64::from(v)));
        let r = &e.reading;
        let mut physical = json!({
            "gain": some(r.gain),
            "omega0": some(r.omega0),
            "damping": some(r.damping),
            "time_constants_s": r.time_constants.iter().map(|t| number(f64::from(*t))).collect::<Vec<_>>(),
            "poles": r.poles.as_ref().map(|p| p.iter().map(|(re, im)| [*re, *im]).collect::<Vec<_>>()),
            "stable": r.stable,
        });
        for (name, value) in self.force_balance() {
            physical[name] = number(value);
        }
        let [x0, x0c] = self.fits();
        json!({
            "a": list(&e.a),
            "inputs": inputs,
            "sigma": list(&e.sigma),
            "parameters": self.problem.parameter_names(),
            "delay_s": number(self.delay_s()),
            "filter_pole": self.tuning.pole.map(number),
            "filter": self.tuning.own.map(|own| own.coefficients().to_vec()),
            "fit_pct": number(x0),
            "fit_x0c_pct": number(x0c),
            "fit_held_out": self.held_out,
            "iq": number(self.index.iq),
            "iv": number(self.index.iv),
            "samples": self.problem.y.len(),
            "physical": physical,
        })
    }

    fn simulation_figure(&self, signals: &Signals) -> Figure {
        let half = self.problem.y.len() / 2;
        let time = |k: usize| signals.start + k as f64 * signals.dt;
        let points = |y: &[f64]| -> Vec<(f64, f64)> {
            y.iter()
                .enumerate()
                .map(|(k, y)| (time(half + k), *y))
                .collect()
        };
        let measured = &self.problem.y[half..];
        // Broad and pale below the simulation, so that both are seen.
        let mut below = Curve::new("measured", PALE, points(measured));
        below.width = 4;
        let mut curves = vec![below];
        let mut panels = Vec::new();
        let [x0, _] = self.fits();
        if let Some(run) = &self.free_run {
            let error: Vec<f64> = measured.iter().zip(&run.y).map(|(y, s)| y - s).collect();
            curves.push(thin("free simulation", COLOURS[0], points(&run.y)));
            panels.push(Panel {
                title: "measured minus simulated".into(),
                x: "t [s]".into(),
                y: "error".into(),
                curves: vec![thin("error", COLOURS[1], points(&error))],
                range: None,
            });
        }
        panels.insert(
            0,
            Panel {
                title: format!("second half of the record, fit {x0:.2} %"),
                x: "t [s]".into(),
                y: "output".into(),
                curves,
                range: None,
            },
        );
        Figure {
            title: "Free simulation of the identified model".into(),
            panels,
        }
    }

    fn transient_figure(&self, signals: &Signals, trace: &Trace) -> Figure {
        // Three times what the parameters still move after the first fifth of the run.
        let settled = &trace.rows[trace.rows.len() / 5..];
        let end = &self.estimate.theta;
        let moved = settled.iter().flat_map(|(_, theta, _)| {
            theta
                .iter()
                .zip(end)
                .map(|(now, end)| (now / end - 1.0).abs())
        });
        let half = (3.0 * moved.fold(0.0, f64::max)).clamp(0.01, 1.0);
        let curves =
            self.problem
                .parameter_names()
                .into_iter()
                .enumerate()
                .map(|(j, name)| {
                    let end = self.estimate.theta[j];
                    let points = trace.rows.iter().map(|(k, theta, _)| {
                        (signals.start + *k as f64 * signals.dt, theta[j] / end)
                    });
                    let band = trace.rows.iter().map(|(_, theta, sigma)| {
                        let width = 2.0 * sigma[j] / end.abs();
                        (theta[j] / end - width, theta[j] / end + width)
                    });
                    let mut curve = Curve::new(name, COLOURS[j % COLOURS.len()], points.collect());
                    curve.band = Some(band.collect());
                    curve
                })
                .collect();
        let panel = Panel {
            title: "each parameter over its final value, band +-2 sigma".into(),
            x: "t [s]".into(),
            y: "relative value".into(),
            curves,
            range: Some(1.0 - half..1.0 + half),
        };
        Figure {
            title: "Course of the parameters".into(),
            panels: vec![panel],
        }
    }
}

fn thin(name: &str, colour: plotters::style::RGBColor, points: Vec<(f64, f64)>) -> Curve {
    let mut curve = Curve::new(name, colour, points);
    curve.width = 1;
    curve
}
