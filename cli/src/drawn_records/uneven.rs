//! The same drive under jitter and with missing rows.

use super::{Drive, read};
use crate::draws::Uniform;
use crate::record::{Clock, Record};
use trendid_identify::{
    Choice, Freedom, Hold, Input, Options, Problem, Signals, Structure, identify,
};

/// Deviations of the model of a record from the truth, in standard deviations.
pub(super) fn deviations(record: &Record, truth: &[f64]) -> Vec<f64> {
    let input = |name, c: usize| Input {
        name,
        samples: &record.signals[c],
        delayed: true,
        hold: Hold::Zero,
    };
    let signals = Signals {
        dt: record.dt,
        output: &record.signals[0],
        inputs: vec![input("u", 1), input("w", 2)],
        standstill: None,
    };
    let structure = Structure::of_order(1);
    let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
    let freedom = Freedom {
        delay: Choice::Given(0),
        ..Freedom::default()
    };
    let e = identify(&problem, freedom, 0, &())
        .expect("a model")
        .estimate;
    let each = truth.iter().zip(e.theta.iter().zip(&e.sigma));
    each.map(|(truth, (found, sigma))| (found - truth) / sigma)
        .collect()
}

/// Rows that are missing are not known: what the inputs did in them is in the noise.
#[test]
fn jitter_and_missing_rows_are_within_the_deviations() {
    let mut all = Vec::new();
    for seed in 1..=40_u64 {
        let mut draw = Uniform::of(seed);
        let jitter = draw.one(&[0.0, 0.02, 0.08, 0.15]);
        let noise = draw.one(&[1e-2, 1e-3, 1e-4]);
        let mut drive = Drive::of(&mut draw, 1500, jitter, noise);
        let missing = draw.one(&[0, 1, 10]);
        for _ in 0..missing {
            let row = 1 + draw.below(drive.rows.len() - 2);
            drive.rows.remove(row);
        }
        let record = read(drive.table(9).as_bytes(), Clock::SECONDS).expect("a record");
        let resampling = record.notes.resampling;
        assert_eq!(resampling.filled, missing, "{seed}");
        assert_eq!(resampling.jitter.is_some(), jitter > 0.01, "{seed}");
        let z = deviations(&record, &drive.truth);
        assert!(z.iter().all(|z| z.abs() < 5.0), "{seed}: {z:?}");
        all.extend(z);
    }
    let rms = (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
    println!("rms {rms:.2}");
    assert!(rms < 1.5, "{rms}");
}
