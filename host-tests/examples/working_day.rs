//! A working day of the position loop on five axes: moves, sines, small steps and rests, without
//! any fault.
//!
//! `cargo run --release -p trendid-host-tests --example working_day -- 86400`; fails when a loop
//! stops that follows its reference.

use trendid_host_tests::servo::faults::normal::{NormalRun, controlled, work};
use trendid_host_tests::servo::population::family::Family;

/// First seed of each family; claims are made on seeds above 200000.
const FIRST: u64 = 200_001;

/// How many axes of each family.
const AXES: [(Family, usize); 3] = [
    (Family::Pneumatic, 2),
    (Family::Linear, 2),
    (Family::BallScrew, 1),
];

/// An error over the travel beyond which the loop has lost the axis, and may stop.
const LOST: f64 = 0.05;

fn main() {
    let seconds: f64 = std::env::args()
        .nth(1)
        .map_or(Ok(60.0), |word| word.parse())
        .unwrap_or_else(|error| panic!("seconds of work: {error}"));
    let axes: Vec<_> = AXES
        .into_iter()
        .flat_map(|(family, count)| {
            let axes = controlled(family, true, FIRST, count);
            axes.into_iter().map(move |axis| (family, axis))
        })
        .collect();
    let runs: Vec<_> = std::thread::scope(|scope| {
        let runs: Vec<_> = axes
            .iter()
            .map(|(_, axis)| scope.spawn(move || work(axis, seconds)))
            .collect();
        runs.into_iter()
            .map(|run| run.join().expect("no panic"))
            .collect()
    });
    println!(
        "| axis | seed | worked [s] | largest error [% of travel] | readings replaced | oscillations | stopped |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut faults = 0;
    for ((family, axis), run) in axes.iter().zip(runs) {
        let Some(run) = run else {
            println!("| {family:?} | {} | no loop | | | | |", axis.seed);
            faults += 1;
            continue;
        };
        faults += u32::from(is_wrong(&run));
        println!(
            "| {family:?} | {} | {:.0} | {:.2} | {} | {} | {} |",
            run.seed,
            run.worked_s,
            100.0 * run.worst,
            run.implausible,
            run.oscillations,
            run.stopped
                .map_or("-".into(), |(reason, at)| format!("{at:.1} s: {reason}"))
        );
    }
    if faults > 0 {
        eprintln!("{faults} of {} axes stopped without a fault", axes.len());
        std::process::exit(1);
    }
}

/// Whether a loop stopped that followed its reference, or reported what is no number.
fn is_wrong(run: &NormalRun) -> bool {
    !run.worst.is_finite() || (run.stopped.is_some() && run.worst < LOST)
}
