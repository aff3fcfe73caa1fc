//! Whether the reported standard deviations are about right, on few records; `tests/statistics` has
//! the shares.

use rand::RngExt;
use trendid::estimation::NoiseLevel;
use trendid_host_tests::paper::coverage::{coverage, default};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::{Condition, Stream, generator};

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

/// White noise of 1 to 50 % of the movement over 0.5 to 40 s, both drawn evenly in their logarithm:
/// with time the drive goes further, the noise with it, and its share of the regressors grows.
#[test]
fn any_share_of_white_noise_over_any_time() {
    const RECORDS: u32 = 200;
    let mut random = generator(FIRST, Stream::Other);
    let mut inside = [[0_u32; 6]; 2];
    for seed in (FIRST..).take(RECORDS as usize) {
        let share_pct = 50.0_f64.powf(random.random());
        let seconds = 0.5 * 80.0_f64.powf(random.random());
        let experiment = Experiment::reference(Condition::white_relative(share_pct), seconds);
        let z = default(&experiment.record(seed), (1.0, 50.0));
        for (count, most) in inside.iter_mut().zip([1.0, 3.0]) {
            for (count, z) in count.iter_mut().zip(z) {
                *count += u32::from(z.abs() <= most);
            }
        }
    }
    println!("of {RECORDS} within 1 and 3 standard deviations: {inside:?}");
    // The share within one scatters by 3.3 %, that within three by 0.4 %: four times that.
    let [one, three] =
        inside.map(|counts| counts.map(|count| 100.0 * f64::from(count) / f64::from(RECORDS)));
    assert!(
        one.iter().all(|share| (55.0..=82.0).contains(share)),
        "{one:?}"
    );
    assert!(three.iter().all(|share| *share >= 98.0), "{three:?}");
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
