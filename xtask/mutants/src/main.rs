//! Does a test notice when a line of the core is wrong?
//!
//! cargo-mutants names the changes. Here a draw of them goes into one build, each behind a switch;
//! every test says which of them it reaches, and those are run with the mutant, the quickest first,
//! until one fails.

mod blame;
mod list;
mod report;
mod switch;
mod tests;
mod tree;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;

use list::Mutant;
use tests::Verdict;

/// Draws mutants of the core, and says which the tests notice.
#[derive(Debug, Parser)]
struct Options {
    /// Mutants that are drawn of each room; every one without this.
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// Seed of the draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Only mutants in files whose path contains this, or one of several.
    #[arg(long, value_name = "TEXT")]
    only: Vec<String>,
    /// Tests that take longer than this without a mutant are left out: what they alone would notice
    /// counts as missed.
    #[arg(long, value_name = "S", default_value_t = 3600.0)]
    longest: f64,
    /// Only the unit tests of the core, which are quick to build and to run: what the host tests
    /// alone would notice counts as missed.
    #[arg(long)]
    unit: bool,
    /// Tests at once.
    #[arg(long, value_name = "N", default_value_t = 2)]
    jobs: usize,
    /// Where the copy of the work tree and its build stand.
    #[arg(long, value_name = "DIR", default_value = "target/mutants")]
    place: PathBuf,
}

/// What is mutated.
const ROOMS: [&str; 4] = [
    "src/estimation/",
    "src/readout/",
    "src/identifier/",
    "src/servo/",
];

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(low) if low.is_empty() => ExitCode::SUCCESS,
        Ok(low) => {
            eprintln!("less than 90 % are caught in {}", low.join(", "));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<Vec<String>, String> {
    let mut root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    root.pop();
    root.pop();
    let mutants = drawn(&root, options)?;
    // Before anything takes long: the sources may change meanwhile.
    let known = report::Known::read(&root, &mutants)?;
    let place = root.join(&options.place);
    let tree = tree::Tree::new(&root, &place)?;
    let unviable = tree.plant(&mutants)?;
    for (number, reason) in &unviable {
        eprintln!("unviable: {}: {reason}", mutants[*number as usize].name);
    }
    let programs = tree.programs(options.unit)?;
    let longest = Duration::from_secs_f64(options.longest);
    let (tests, left) = tests::record(&programs, options.jobs, longest, &place)?;
    eprintln!("{} tests, {left} left out", tests.len());
    let numbers: Vec<u32> = (0..mutants.len() as u32)
        .filter(|number| !unviable.contains_key(number))
        .collect();
    let found = tests::side_by_side(options.jobs, numbers.len(), |k| {
        let verdict = tests::judge(&programs, &tests, numbers[k]);
        eprintln!("{}: {verdict:?}", mutants[numbers[k] as usize].name);
        verdict
    });
    let verdicts: BTreeMap<u32, Verdict> = numbers.into_iter().zip(found).collect();
    println!(
        "{} tests, {left} more that take longer than {} s left out\n",
        tests.len(),
        options.longest
    );
    Ok(report::print(&ROOMS, &mutants, &verdicts, &known))
}

/// The draw of all rooms.
fn drawn(root: &std::path::Path, options: &Options) -> Result<Vec<Mutant>, String> {
    let mut drawn = Vec::new();
    for room in ROOMS {
        let mut all = list::all(root, room)?;
        let wanted = |file: &str| {
            options.only.is_empty() || options.only.iter().any(|part| file.contains(part))
        };
        all.retain(|mutant| wanted(&mutant.file));
        drawn.extend(list::draw(all, options.sample, options.seed));
    }
    if drawn.len() > tree::MOST {
        return Err(format!("{} mutants, {} fit", drawn.len(), tree::MOST));
    }
    Ok(drawn)
}
