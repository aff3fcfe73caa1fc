//! `trendid users`: the identifier with users drawn at random.

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde_json::{Map, Value, json};
use trendid_host_tests::users::figures::{Far, Figures, LIMITS, Part, duel, worst};
use trendid_host_tests::users::kind::Kind;
use trendid_host_tests::users::trial::{Special, Trial};

use crate::format::significant;
use crate::output::{Refusal, emit, emit_json, number, progress, under};
use crate::seeds::seeds;

/// Errors in standard deviations over users drawn at random, with all that they tell wrong
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  trendid users --population 500
  trendid users --population 500 --first-seed 300001 --kind servo --worst
  trendid users --population 100 --json

A user has a drive of one of twelve structures (a fifth have the one to start with, `servo`), a natural frequency w of 2 to
100 rad/s, a damping of 0.1 to 1.2, 0.25 to 10 ms between samples, units of 1e-3 to 1e3 for the command and 1e-6 to 1e6 for the
output, and 30 to 300/w of time (200 to 60000 samples); a zero lies at 0.5 to 5 w, the fourth pole at 1 to 4 w, a dead zone is 1
to 15 % of the command. It tells the bandwidth 0.4 to 2.5 times, the ranges and, in every other
case, the noise 0.1 to 10 times as large as they are, and no memory or one of 0.5, 2 or 10 s. It moves the drive by binary noise,
a sine, steps, five sines or pulses, or a position by triangles or moves of a reference under proportional control. The noise is
0 to 10 % of the motion; now and then the position is quantised (to 1 % of the motion) or far from zero (to 1e4 motions), the
valve has an offset (to 10 % of the command), samples are missed, positions are no numbers or spikes (to three motions), or the
bandwidth is told anew (after 25/w, 0.7 to 1.5 w). It reads after 10, 30 and 100/w and at the end.

Columns:
  readings       how many; a row of `special` has the users to whom that happened, whatever else did
  > 1 .. > 10    share of the readings whose largest error exceeds so many of the standard deviations given with it: every
                 a, b and the constant, C, omega0 and xi where they exist, and the width of a dead zone
  no deviation   share in which one of the deviations is not finite
  within 10 %    share in which every error is below 10 % of the truth; of the constant and of the sign of a dead zone below
                 10 % of what a command makes

The second table has C, omega0 and xi alone, of the users whose drive is of order 3 without a zero: the identifier, and beside it
an extended Kalman filter in f64 that is told the true noise, and middle and spread of the ranges above. --worst names the users
with the largest errors.")]
pub(crate) struct UsersArgs {
    /// How many users
    #[arg(long, value_name = "N", default_value_t = 500)]
    population: u64,
    /// Seed of the first user
    #[arg(long, value_name = "N", default_value_t = 200_001)]
    first_seed: u64,
    /// Only this structure
    #[arg(long, value_name = "NAME", value_parser = kind_names())]
    kind: Option<String>,
    /// Name the ten users with the largest errors
    #[arg(long)]
    worst: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

fn kind_names() -> PossibleValuesParser {
    PossibleValuesParser::new(Kind::ALL.map(Kind::name))
}

/// How many users are named.
const NAMED: usize = 10;

/// Runs the users and prints the tables.
///
/// # Errors
///
/// A sentence on a number of users that makes no sense.
pub(crate) fn run(args: &UsersArgs) -> Result<(), Refusal> {
    let seeds = seeds("--population", args.population, args.first_seed)?;
    let kind = args.kind.as_deref().and_then(Kind::from_name);
    let bar = progress(args.population, "users");
    let trials = under(&bar, &seeds, |seed| Trial::run(*seed, kind));
    bar.finish_and_clear();
    let found = Found::new(&trials, args.worst);
    match args.json {
        true => emit_json(&found.json()),
        false => emit(&found.text(args.first_seed, args.first_seed + (args.population - 1))),
    }
}

/// What came of the users.
struct Found<'a> {
    users: usize,
    /// Seeds whose settings were refused, each with the sentence.
    refused: Vec<(u64, &'a str)>,
    parts: Vec<(Part, Figures)>,
    duel: [(&'static str, Figures); 2],
    worst: Vec<Far<'a>>,
}

impl<'a> Found<'a> {
    fn new(trials: &'a [Trial], named: bool) -> Self {
        let refused = trials.iter().filter_map(|trial| {
            let sentence = trial.read.as_ref().err()?;
            Some((trial.user.seed, sentence.as_str()))
        });
        let parts = Part::all().into_iter().map(|part| {
            let readings = part.readings(trials);
            (part, Figures::new(&readings))
        });
        let [own, filter] = duel(trials);
        Self {
            users: trials.len(),
            refused: refused.collect(),
            parts: parts.filter(|(_, figures)| figures.readings > 0).collect(),
            duel: [("trendid", own), ("extended Kalman filter", filter)],
            worst: worst(trials, if named { NAMED } else { 0 }),
        }
    }

    fn json(&self) -> Value {
        let parts = self.parts.iter().map(|(part, figures)| {
            let [by, name] = part.names();
            let mut row = object(figures);
            row.insert("by".into(), json!(by));
            row.insert("part".into(), json!(name));
            Value::Object(row)
        });
        let duel = self.duel.iter().map(|(name, figures)| {
            let mut row = object(figures);
            row.insert("estimator".into(), json!(name));
            Value::Object(row)
        });
        let refused = self.refused.iter();
        let mut top = json!({
            "users": self.users,
            "refused": refused.map(|(seed, why)| json!({"seed": seed, "why": why})).collect::<Value>(),
            "parts": parts.collect::<Value>(),
            "physical": duel.collect::<Value>(),
        });
        if !self.worst.is_empty() {
            top["worst"] = self.worst.iter().map(far_object).collect();
        }
        top
    }

    fn text(&self, first: u64, last: u64) -> String {
        let mut text = format!(
            "{} users, seeds {first} to {last}; the settings of {} were refused.\n\n{}",
            self.users,
            self.refused.len(),
            head("readings")
        );
        for (part, figures) in &self.parts {
            let [by, name] = part.names();
            let title = if by == name {
                name.into()
            } else {
                format!("{by}: {name}")
            };
            text += &line(&title, figures);
        }
        if self.duel[1].1.readings > 0 {
            text += &format!("\n{}", head("C, omega0, xi"));
            for (name, figures) in &self.duel {
                text += &line(name, figures);
            }
        }
        let unsound = self.parts.first().map_or(0, |(_, all)| all.unsound);
        text +=
            &format!("\nReadings with a number that is none, or a deviation of 0: {unsound}.\n");
        if !self.worst.is_empty() {
            text += "\n| seed | structure | command | special | after | worst | deviations | error [%] |\n|---|---|---|---|---|---|---|---|\n";
        }
        for far in &self.worst {
            text += &far_line(far);
        }
        text
    }
}

fn head(title: &str) -> String {
    let limits = LIMITS.map(|limit| format!("> {limit} \\[%\\]"));
    format!(
        "| {title} | number | {} | no deviation \\[%\\] | within 10 % \\[%\\] |\n|---|---|---|---|---|---|---|---|\n",
        limits.join(" | ")
    )
}

fn line(title: &str, figures: &Figures) -> String {
    let shares = figures.beyond.into_iter();
    let shares = shares.chain([figures.without_deviation, figures.good]);
    let shares: Vec<String> = shares.map(|share| format!("{share:.1}")).collect();
    format!(
        "| {title} | {} | {} |\n",
        figures.readings,
        shares.join(" | ")
    )
}

fn object(figures: &Figures) -> Map<String, Value> {
    let mut row = Map::new();
    row.insert("readings".into(), json!(figures.readings));
    for (limit, share) in LIMITS.into_iter().zip(figures.beyond) {
        row.insert(format!("beyond_{limit}_pct"), number(share));
    }
    row.insert("no_deviation_pct".into(), number(figures.without_deviation));
    row.insert("within_10_pct".into(), number(figures.good));
    row.insert("unsound".into(), json!(figures.unsound));
    row
}

/// What is special about a user.
fn specials(trial: &Trial) -> Vec<&'static str> {
    let all = Special::HAPPENS.into_iter();
    all.filter(|special| trial.has(*special))
        .map(Special::name)
        .collect()
}

/// Name and error \[%\] of the quantity that is furthest out.
fn furthest(far: &Far<'_>) -> (String, f64) {
    let quantity = far.reading.worst();
    quantity.map_or_else(Default::default, |q| (q.name.clone(), 100.0 * q.error()))
}

fn far_object(far: &Far<'_>) -> Value {
    let (name, error) = furthest(far);
    json!({
        "seed": far.trial.user.seed,
        "structure": far.trial.user.kind.name(),
        "command": far.trial.user.command.name(),
        "special": specials(far.trial),
        "after_1_w": number(far.reading.time),
        "quantity": name,
        "deviations": number(far.deviations),
        "error_pct": number(error),
    })
}

fn far_line(far: &Far<'_>) -> String {
    let (name, error) = furthest(far);
    format!(
        "| {} | {} | {} | {} | {:.0}/w | {name} | {} | {} |\n",
        far.trial.user.seed,
        far.trial.user.kind.name(),
        far.trial.user.command.name(),
        specials(far.trial).join(", "),
        far.reading.time,
        significant(far.deviations, 3),
        significant(error, 2),
    )
}
