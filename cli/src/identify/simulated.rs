//! `trendid select --simulated`: how often the structure of a drawn plant is found.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use trendid_host_tests::plants::drawn::DrawnRecord;
use trendid_identify::structure_choice::{Range, Selection, select};
use trendid_identify::{Choice, Freedom, Options, Signals, Structure, side_by_side};

use crate::format::table;
use crate::output::Refusal;
use crate::seeds::seeds;

/// Result of one plant.
struct Trial {
    truth: (Structure, usize),
    drift: bool,
    /// Structure and delay; none where no structure passed.
    found: Option<(Structure, usize)>,
}

/// Counts over some plants.
#[derive(Default, Clone, Copy)]
struct Count {
    plants: usize,
    hits: usize,
    delays: usize,
}

impl Count {
    fn add(&mut self, trial: &Trial) {
        self.plants += 1;
        if let Some((structure, delay)) = trial.found
            && structure == trial.truth.0
        {
            self.hits += 1;
            self.delays += usize::from(delay == trial.truth.1);
        }
    }

    fn percent(self) -> f64 {
        100.0 * self.hits as f64 / self.plants.max(1) as f64
    }

    fn json(self) -> Value {
        json!({"plants": self.plants, "hits": self.hits, "hit_pct": self.percent(), "delay_too": self.delays})
    }
}

/// The results of all plants.
pub(crate) struct Simulated {
    first_seed: u64,
    trials: Vec<Trial>,
}

fn chosen(selection: &Selection) -> (Structure, usize) {
    let c = &selection.candidates[selection.recommended];
    (c.structure, c.delay)
}

fn trial(seed: u64) -> Trial {
    let drawn = DrawnRecord::of(seed);
    let signals = Signals::held(drawn.dt, &drawn.u, &drawn.y);
    let truth = Structure {
        order: drawn.a.len(),
        integrator: drawn.integrator,
        zeros: drawn.zeros(),
        constant: true,
    };
    let range = Range {
        max_order: 3,
        integrating: false,
        constant: true,
    };
    let freedom = Freedom {
        pole: Choice::Auto,
        delay: Choice::Auto,
    };
    let selection = select(&signals, range, Options::default(), freedom, &());
    Trial {
        truth: (truth, drawn.delay),
        drift: drawn.drift,
        found: selection.ok().as_ref().map(chosen),
    }
}

fn name(s: Structure) -> String {
    format!(
        "{}{}/{}",
        s.order,
        if s.integrator { "I" } else { "" },
        s.zeros
    )
}

impl Simulated {
    /// Draws so many plants from a seed on and chooses the structure of each.
    ///
    /// # Errors
    ///
    /// A number of plants or a seed that makes no sense.
    pub(crate) fn run(plants: u64, first_seed: u64) -> Result<Self, Refusal> {
        let seeds = seeds("--simulated", plants, first_seed)?;
        let trials = side_by_side(&seeds, |seed| trial(*seed));
        Ok(Self { first_seed, trials })
    }

    fn count(&self, which: impl Fn(&Trial) -> bool) -> Count {
        let mut count = Count::default();
        for trial in self.trials.iter().filter(|t| which(t)) {
            count.add(trial);
        }
        count
    }

    /// How often which structure was taken for which.
    fn confusion(&self) -> BTreeMap<String, BTreeMap<String, usize>> {
        let mut rows: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for trial in &self.trials {
            let found = trial.found.map_or("none".into(), |(s, _)| name(s));
            *rows
                .entry(name(trial.truth.0))
                .or_default()
                .entry(found)
                .or_default() += 1;
        }
        rows
    }

    /// The report for people.
    pub(crate) fn text(&self) -> String {
        let all = self.count(|_| true);
        let mut text = format!(
            "{} plants from seed {} on: structure found for {} ({:.1} %), its delay too for {}\n",
            all.plants,
            self.first_seed,
            all.hits,
            all.percent(),
            all.delays
        );
        for (drift, kind) in [(false, "white noise"), (true, "mostly drift")] {
            let count = self.count(|t| t.drift == drift);
            text += &format!(
                "  {kind}: {} of {} ({:.1} %)\n",
                count.hits,
                count.plants,
                count.percent()
            );
        }
        text += "\nRows: true structure (order, I = integrator, / zeros); what was found\n";
        let rows = self.confusion().into_iter().map(|(truth, found)| {
            let mut found: Vec<(String, usize)> = found.into_iter().collect();
            found.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
            let found: Vec<String> = found
                .iter()
                .map(|(name, n)| format!("{name}: {n}"))
                .collect();
            vec![truth, found.join(", ")]
        });
        text + &table(&rows.collect::<Vec<_>>())
    }

    /// The report for machines.
    pub(crate) fn json(&self) -> Value {
        let mut value = self.count(|_| true).json();
        value["first_seed"] = json!(self.first_seed);
        value["white"] = self.count(|t| !t.drift).json();
        value["drift"] = self.count(|t| t.drift).json();
        value["confusion"] = json!(self.confusion());
        value
    }
}
