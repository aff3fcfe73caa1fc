//! Free simulation of an identified model in f64, the judge of its fit.

use trendid_host_tests::plants::linear::{Input, LinearPlant};

use crate::symmetric::nearest;

/// How an input behaves between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Hold {
    /// Zero-order hold: constant until the next sample.
    Zoh,
    /// First-order hold: straight to the next sample.
    Foh,
}

/// `A(s) y = sum_j B_j(s) u_j(t - d dt) + constant`, coefficients ascending,
/// `A` without its leading one.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub a: Vec<f64>,
    pub b: Vec<Vec<f64>>,
    /// Delay of each input in samples.
    pub delay: Vec<usize>,
    /// Hold of each input.
    pub hold: Vec<Hold>,
    pub constant: f64,
}

/// A model run on the inputs alone against a measured output.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRun {
    /// Simulated output with the initial state refitted.
    pub y: Vec<f64>,
    /// `100 (1 - |y - y_sim| / |y - mean(y)|)`, initial state refitted.
    pub fit_x0: f64,
    /// The same with the constant of the differential equation refitted too.
    pub fit_x0c: f64,
}

impl Model {
    /// Simulates samples `range` of the record and compares with `y` there;
    /// the inputs before the range serve the delays.
    ///
    /// The output is linear in the initial state and in the constant, so both
    /// are least-squares fits. `None` when the model cannot be simulated or
    /// runs away.
    pub fn free_run(
        &self,
        u: &[&[f64]],
        y: &[f64],
        range: std::ops::Range<usize>,
        dt: f64,
    ) -> Option<FreeRun> {
        let measured = &y[range.clone()];
        let forced = self.response(Some(u), self.constant, None, range.clone(), dt)?;
        let mut columns = Vec::new();
        for i in 0..self.a.len() {
            let mut derivatives = vec![0.0; self.a.len()];
            derivatives[i] = 1.0;
            columns.push(self.response(None, 0.0, Some(&derivatives), range.clone(), dt)?);
        }
        let rest: Vec<f64> = measured.iter().zip(&forced).map(|(y, f)| y - f).collect();
        let (state, fit_x0) = refit(&columns, &rest, measured)?;
        let simulated = forced.iter().zip(&state).map(|(f, s)| f + s).collect();
        columns.push(self.response(None, 1.0, None, range, dt)?);
        let (_, fit_x0c) = refit(&columns, &rest, measured)?;
        Some(FreeRun {
            y: simulated,
            fit_x0,
            fit_x0c,
        })
    }

    /// The response over `range` to the inputs, to a constant, or to initial
    /// derivatives of the output.
    fn response(
        &self,
        inputs: Option<&[&[f64]]>,
        constant: f64,
        initial: Option<&[f64]>,
        range: std::ops::Range<usize>,
        dt: f64,
    ) -> Option<Vec<f64>> {
        let columns: Vec<Input> = self.b.iter().map(|b| Input::new(b)).collect();
        let mut plant = LinearPlant::with_inputs(&self.a, &columns, constant, dt).ok()?;
        if let Some(derivatives) = initial {
            plant.place(derivatives);
        }
        let at = |k: usize| -> Vec<f64> {
            match inputs {
                // A delayed sample from before the record is its first one.
                Some(u) => u
                    .iter()
                    .zip(&self.delay)
                    .map(|(u, d)| u[k.saturating_sub(*d)])
                    .collect(),
                None => vec![0.0; self.b.len()],
            }
        };
        let mut out = Vec::with_capacity(range.len());
        let mut now = at(range.start);
        for k in range.clone() {
            out.push(plant.output());
            if k + 1 < range.end {
                let next = at(k + 1);
                if inputs.is_some() && self.hold.contains(&Hold::Foh) {
                    let held = now.iter().zip(&next).zip(&self.hold);
                    let end: Vec<f64> = held
                        .map(|((now, next), hold)| if *hold == Hold::Foh { *next } else { *now })
                        .collect();
                    plant.step_ramp(&now, &end);
                } else {
                    plant.step(&now);
                }
                now = next;
            }
        }
        out.iter().all(|v| v.is_finite()).then_some(out)
    }
}

/// Least-squares combination of `columns` nearest to `rest`, and the fit in
/// percent of what remains against the spread of `measured`.
fn refit(columns: &[Vec<f64>], rest: &[f64], measured: &[f64]) -> Option<(Vec<f64>, f64)> {
    let combination = nearest(columns, rest);
    let mean = measured.iter().sum::<f64>() / measured.len() as f64;
    let spread = measured
        .iter()
        .map(|y| (y - mean).powi(2))
        .sum::<f64>()
        .sqrt();
    let error = rest
        .iter()
        .zip(&combination)
        .map(|(r, c)| (r - c).powi(2))
        .sum::<f64>()
        .sqrt();
    let fit: f64 = 100.0 * (1.0 - error / spread);
    fit.is_finite().then_some((combination, fit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_fits_its_own_response_from_any_state_and_offset() {
        let dt = 0.01;
        let (a, b) = ([0.0, 3.0], [2.0]);
        let u: Vec<f64> = (0..600)
            .map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.7 })
            .collect();
        let delayed = Input::delayed(&b, 3);
        let mut plant = LinearPlant::with_inputs(&a, &[delayed], 0.4, dt).unwrap();
        plant.place(&[5.0, -1.0]);
        let y = plant.response(&u);
        let model = |constant, delay| Model {
            a: a.to_vec(),
            b: vec![b.to_vec()],
            delay: vec![delay],
            hold: vec![Hold::Zoh],
            constant,
        };
        let run = |m: &Model| m.free_run(&[&u], &y, 300..600, dt).unwrap();
        let exact = run(&model(0.4, 3));
        assert!(exact.fit_x0 > 99.999_999, "{}", exact.fit_x0);
        assert!((exact.y[299] - y[599]).abs() < 1e-8);
        // The constant is refitted for the second figure only.
        let without = run(&model(0.0, 3));
        assert!(without.fit_x0 < 90.0 && without.fit_x0c > 99.999_999);
        assert!(run(&model(0.4, 0)).fit_x0c < 99.5);
        // What runs away is not a fit.
        let unstable = Model {
            a: vec![-1.0, -5e3],
            ..model(0.4, 3)
        };
        assert_eq!(unstable.free_run(&[&u], &y, 300..600, dt), None);
    }

    #[test]
    fn a_first_order_hold_goes_straight_to_the_next_sample() {
        // y' = u with u = t: the straight line is exact, the held one is not.
        let dt = 0.1;
        let t: Vec<f64> = (0..100).map(|k| f64::from(k) * dt).collect();
        let y: Vec<f64> = t.iter().map(|t| 0.5 * t * t).collect();
        let model = |hold| Model {
            a: vec![0.0],
            b: vec![vec![1.0]],
            delay: vec![0],
            hold: vec![hold],
            constant: 0.0,
        };
        let fit = |hold| model(hold).free_run(&[&t], &y, 0..100, dt).unwrap().fit_x0;
        assert!(fit(Hold::Foh) > 99.999_999);
        assert!(fit(Hold::Zoh) < 99.9);
    }
}
