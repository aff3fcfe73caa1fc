//! The loop on the nominal axis and after changes, over many draws of noise and excitation: one run
//! says little about an axis with friction.

use trendid_host_tests::servo::bridging::SINE_MAX_MM;
use trendid_host_tests::servo::figures::Figures;
use trendid_host_tests::servo::run::{Options, run_with, stating};
use trendid_host_tests::servo::scenario::Scenario;

/// A figure and the largest values of its median, its 90 % and its 99 %: the worst of many draws
/// says more of how many they are.
type Phase = (&'static str, fn(&Figures) -> Option<f64>, [f64; 3]);

/// Seeds of the test: none was used to tune anything. So many that no two or three of them are the
/// 99 %.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=500;

/// A run of a seed, whose user guesses the bandwidth at 0.7 to 1.4 times the usual guess: with it
/// the whole excitation is another one.
fn drawn(scenario: Scenario, seed: u64) -> Figures {
    let options = Options::adaptive(seed);
    let ratio = 0.7 + 0.007 * (37 * seed % 100) as f32;
    run_with(
        scenario,
        &options,
        &stating(&options, ratio),
        &mut |_, _| {},
    )
}

/// What 500 draws showed (median, 90 %, 99 %): verified after 1.00, 1.12, 1.36 s; steady state
/// 0.034, 0.057, 0.072 mm (wanted: 0.05, which the median meets); rise 98, 101, 103 ms; overshoot
/// 0.09, 0.15, 0.57 % (wanted: 1, three are beyond); 0.5 Hz 0.54, 0.78, 1.03 mm (wanted: 1.02); 1
/// Hz 0.61, 0.76, 0.96 mm (wanted: 0.72, which the median meets).
const PHASES: [Phase; 6] = [
    ("verified in s", |f| f.verified_at_s, [1.4, 1.8, 3.0]),
    (
        "steady state in mm",
        |f| f.steady_state_mm,
        [0.05, 0.08, 0.15],
    ),
    ("rise in ms", |f| f.rise_ms, [120.0, 120.0, 200.0]),
    ("overshoot in %", |f| f.overshoot_pct, [0.3, 0.6, 1.0]),
    ("0.5 Hz in mm", |f| f.tracking_0p5hz_mm, SINE_MAX_MM),
    ("1 Hz in mm", |f| f.tracking_1hz_mm, [0.75, 0.95, 1.2]),
];

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn the_axis_commissions_itself_and_follows() {
    let runs: Vec<_> = SEEDS.map(|seed| drawn(Scenario::Nominal, seed)).collect();
    let mut faults = String::new();
    for (name, figure, limits) in PHASES {
        // What a run does not come to is worse than any figure.
        let mut of_run: Vec<_> = runs
            .iter()
            .map(|f| (figure(f).unwrap_or(f64::INFINITY), f.seed))
            .collect();
        of_run.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |share: f64| of_run[(share * (of_run.len() - 1) as f64).round() as usize];
        let found = [at(0.5), at(0.9), at(0.99)];
        println!("{name}: {found:.4?}, worst {:.4?}", at(1.0));
        if found.iter().zip(limits).any(|((x, _), limit)| *x > limit) {
            faults +=
                &format!("{name}: median, 90 %, 99 % (seed) {found:.4?}, limits {limits:?}\n");
        }
    }
    assert!(faults.is_empty(), "{faults}");
}

/// Largest median and worst of the steady state and of the sine of 1 Hz after a change, in mm; 30
/// draws show 0.05 and 0.15 mm, 1.9 and 2.4 mm at most, three times the mass among them.
const AFTER: [[f64; 2]; 2] = [[0.1, 0.25], [2.5, 3.0]];

fn changes_are_survived(seeds: &std::ops::RangeInclusive<u64>) {
    let mut faults = String::new();
    for scenario in Scenario::ALL.into_iter().filter(|s| s.is_change()) {
        let runs: Vec<_> = seeds.clone().map(|seed| drawn(scenario, seed)).collect();
        let name = scenario.name();
        assert!(
            runs.iter().all(|f| f.state.is_controlling()),
            "{name}: given up"
        );
        let figures: [fn(&Figures) -> Option<f64>; 2] =
            [|f| f.steady_state_mm, |f| f.tracking_1hz_mm];
        for (figure, limits) in figures.into_iter().zip(AFTER) {
            let mut of_run: Vec<_> = runs
                .iter()
                .map(|f| figure(f).unwrap_or(f64::INFINITY))
                .collect();
            of_run.sort_by(f64::total_cmp);
            let found = [of_run[of_run.len() / 2], of_run[of_run.len() - 1]];
            if found.iter().zip(limits).any(|(x, limit)| *x > limit) {
                faults += &format!("{name}: median, worst in mm {found:.3?}, limits {limits:?}\n");
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn changes_in_motion_are_survived() {
    changes_are_survived(&(3001..=3010));
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn thirty_draws_of_each_change_in_motion_are_survived() {
    changes_are_survived(&(3001..=3030));
}
