//! Stamps of a clock as coarse as the rows: read right, or refused.

use super::uneven::deviations;
use super::{Drive, read};
use crate::draws::Uniform;
use crate::record::{Clock, Resampling};

/// Intervals in steps of the clock: shorter, as long, and longer.
const INTERVALS: &[f64] = &[0.3, 0.7, 0.9, 0.995, 1.003, 1.005, 1.3, 1.6, 2.5, 3.4, 10.4];

/// What a clock makes of the stamps of rows.
struct Coarse {
    /// Its step in s.
    step: f64,
    /// Whether it is read downwards or to the nearest step.
    down: bool,
    /// Where it stands at the first row, in steps.
    offset: f64,
}

impl Coarse {
    fn of(draw: &mut Uniform, dt: f64, interval: f64) -> Self {
        Self {
            step: dt / interval,
            down: draw.yes(),
            offset: draw.next(),
        }
    }

    fn stamp(&self, t: f64) -> f64 {
        let steps = t / self.step + self.offset;
        match self.down {
            true => steps.floor(),
            false => steps.round(),
        }
    }

    /// The table with stamps in whole steps of 1 ms.
    fn table(&self, drive: &Drive) -> String {
        let mut text = "t_ms,u,w,y\n".to_owned();
        for [t, u, w, y] in &drive.rows {
            text += &format!("{},{u},{w},{y:.6}\n", self.stamp(*t));
        }
        text
    }
}

#[test]
fn rows_behind_a_coarse_clock_are_read_as_they_are() {
    let mut all = Vec::new();
    for seed in 1..=130_u64 {
        let interval = INTERVALS[seed as usize % INTERVALS.len()];
        let mut draw = Uniform::of(seed);
        let rows = 1500 + draw.below(1500);
        let drive = Drive::of(&mut draw, rows, 0.0, 1e-3);
        let clock = Coarse::of(&mut draw, drive.dt, interval);
        let plain = read(drive.table(9).as_bytes(), Clock::SECONDS).expect("the plain record");
        let found = read(clock.table(&drive).as_bytes(), Clock::SECONDS);
        let mut found = found.unwrap_or_else(|e| panic!("{seed}, {interval}: {e}"));
        assert_eq!(found.signals, plain.signals, "{seed}, {interval}");
        assert_eq!(found.notes.resampling, Resampling::default(), "{seed}");
        let said = found.notes.clock.map(|clock| (1e6 * clock).round());
        assert_eq!(said, Some(1e3), "{seed}, {interval}");
        // In steps of 1 ms: a step over the whole record at most.
        let off = 1e3 * found.dt - interval;
        assert!(
            off.abs() * plain.len() as f64 <= 1.0,
            "{seed}, {interval}: {}",
            found.dt
        );
        // The parameters are those of the drive on its own clock.
        found.dt *= 1e3 * clock.step;
        all.extend(deviations(&found, &drive.truth));
    }
    let rms = (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
    println!("rms {rms:.2}");
    assert!(rms < 1.5, "{rms}");
}

/// Where rows are missing, too, the clock says nothing: refused, or few of them filled and said.
#[test]
fn missing_rows_behind_a_coarse_clock_are_not_silent() {
    let (mut refused, mut said) = (0, 0);
    for seed in 1..=130_u64 {
        let interval = INTERVALS[seed as usize % INTERVALS.len()];
        let mut draw = Uniform::of(seed);
        let mut drive = Drive::of(&mut draw, 1500, 0.0, 1e-3);
        let clock = Coarse::of(&mut draw, drive.dt, interval);
        for _ in 0..5 {
            drive.rows.remove(1 + draw.below(1400));
        }
        match read(clock.table(&drive).as_bytes(), Clock::SECONDS) {
            Err(error) => {
                refused += 1;
                let error = error.to_string();
                assert!(error.contains("--dt S"), "{seed}, {interval}: {error}");
            }
            Ok(found) => {
                said += 1;
                let resampling = found.notes.resampling;
                assert!(resampling.filled >= 5, "{seed}, {interval}: {resampling:?}");
                assert_eq!(found.notes.clock, None, "{seed}, {interval}");
            }
        }
    }
    println!("refused {refused}, filled and said {said}");
}
