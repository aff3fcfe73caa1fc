//! Record files drawn at random, as loggers and spreadsheets write them: the same record whatever
//! its form and on whatever way it comes, the same model where stamps jitter, rows are missing or
//! the clock is coarse, and no silent wrong number where one cell or line is broken or the numbers
//! have decimal commas.

mod broken;
mod clocks;
mod forms;
mod uneven;

use std::path::Path;

use crate::draws::Uniform;
use crate::record::{Clock, Record, RecordError};

/// `y' = b0 u + b1 w - a y + noise` at its stamps, u and w held from stamp to stamp.
struct Drive {
    dt: f64,
    /// a, b0, b1.
    truth: [f64; 3],
    /// t, u, w, y.
    rows: Vec<[f64; 4]>,
}

impl Drive {
    /// `jitter` is that of the stamps in sampling intervals, to both sides.
    fn of(draw: &mut Uniform, samples: usize, jitter: f64, noise: f64) -> Self {
        let dt = draw.one(&[1e-3, 2e-3, 5e-3, 1e-2]);
        let a = (0.02 + 0.08 * draw.next()) / dt;
        let truth = [a, a * (1.0 + 3.0 * draw.next()), a * (0.5 + draw.next())];
        let holds = [5 + draw.below(9), 17 + draw.below(40)];
        let mut inputs = [0.0; 2];
        let (mut y, mut rows) = (0.0, Vec::new());
        let mut stamp = |k: usize| {
            let moved = jitter * draw.either_side();
            (k as f64 + if k == 0 { 0.0 } else { moved }) * dt
        };
        let stamps: Vec<f64> = (0..=samples).map(&mut stamp).collect();
        for k in 0..samples {
            for (input, hold) in inputs.iter_mut().zip(holds) {
                if k.is_multiple_of(hold) {
                    *input = draw.one(&[-1.5, 1.5]);
                }
            }
            rows.push([stamps[k], inputs[0], inputs[1], y + noise * draw.normal()]);
            let decay = (-a * (stamps[k + 1] - stamps[k])).exp();
            let end = (truth[1] * inputs[0] + truth[2] * inputs[1]) / a;
            y = end + (y - end) * decay;
        }
        Self { dt, truth, rows }
    }

    /// As a table of commas with these stamps, to so many places.
    fn table(&self, places: usize) -> String {
        let mut text = "t,u,w,y\n".to_owned();
        for [t, u, w, y] in &self.rows {
            text += &format!("{t:.places$},{u},{w},{y:.6}\n");
        }
        text
    }
}

fn read(text: &[u8], clock: Clock) -> Result<Record, RecordError> {
    let signals = ["y", "u", "w"].map(str::to_owned);
    Record::parse(Path::new("x.csv"), text, clock, &signals)
}
