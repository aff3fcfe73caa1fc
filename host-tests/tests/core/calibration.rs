//! Whether the reported standard deviations are about right, on few records; `tests/statistics` has
//! the shares.

use trendid::estimation::NoiseLevel;
use trendid_host_tests::paper::coverage::{coverage, default};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

/// The first of the seeds of `tests/statistics`.
const FIRST: u64 = 370_000;

/// Of 100 records the share within one sigma scatters by 4.7 %: four times that about 68 %.
#[test]
fn open_loop() {
    let experiment = Experiment::reference(Condition::white_relative(8.35), 1.0);
    let seeds = FIRST..FIRST + 100;
    let [one, three] = coverage("open loop, 1 s", default, &experiment, (1.0, 50.0), seeds);
    assert!(three.iter().all(|share| *share >= 97.0), "{three:?}");
    assert!(
        one.iter().all(|share| (49.0..=87.0).contains(share)),
        "{one:?}"
    );
}

/// The level that all of it rests on: the third difference measures white noise and does not see
/// the drive.
#[test]
fn noise_level_is_unbiased() {
    for ns in [1.04, 8.35, 41.78] {
        let experiment = Experiment::reference(Condition::white_relative(ns), 1.0);
        let mut ratios = Vec::new();
        for seed in FIRST..FIRST + 200 {
            let record = experiment.record(seed);
            let mut level = NoiseLevel::new(1.0);
            for y in &record.y {
                level.update(*y as f32);
            }
            let noise = record.noise();
            let power = noise.iter().map(|v| v * v).sum::<f64>() / noise.len() as f64;
            ratios.push(f64::from(level.variance().unwrap()) / power);
        }
        let mean = ratios.iter().sum::<f64>() / 200.0;
        let spread = (ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 200.0).sqrt();
        println!("N/S {ns} %: level over noise {mean:.4}, one run scatters by {spread:.4}");
        // 200 runs: the mean is known to a fourteenth of the scatter of one.
        assert!((mean - 1.0).abs() < 0.01 && spread < 0.1);
    }
}
