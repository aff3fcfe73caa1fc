//! How much an estimate varies, from the noise that its simulation leaves of the output.
//!
//! Blocks of time say nothing where all information is in one of them, as with one step: what the
//! estimate has taken of that block is all there was. But noise is of one kind over the record,
//! also where nothing moves. With v the output less its simulation, M the matrix of the equations
//! and z their instruments,
//!
//! ```text
//! sum_k z_k e_k = sum_j zeta_j v_j     e = (A/A_f) v     zeta = (A/A_f)* z, backward in time
//! Phi(q) v = w, w white of variance s^2     xi = (1/Phi)* zeta
//! P = M^-1 (s^2 sum_j xi_j xi_j') M^-T
//! ```
//!
//! Known as: asymptotic covariance of instrumental variables (Soderstrom and Stoica 1983) behind
//! noise that is an autoregression, its order by Akaike's criterion.

use nalgebra::{DMatrix, DVector};

use crate::instruments::Fit;
use crate::instruments::autoregression::Autoregression;
use crate::instruments::pass::Pass;
use crate::instruments::solve::Whole;

impl Fit<'_> {
    /// Covariance of the columns present by the noise of the output; `None` where the model has no
    /// simulation.
    pub(super) fn of_output_noise(&self, whole: &Whole) -> Option<DMatrix<f64>> {
        let problem = self.problem;
        let mut pass = Pass::of(problem, &self.setting).ok()?;
        let layout = pass.layout.clone();
        let p = layout.parameters();
        let (model, _) = self.in_s_plane(&whole.theta.as_slice()[..p])?;
        let shift = if layout.later { whole.theta[p] } else { 0.0 };
        let delay = (self.setting.delay + shift.clamp(-1.0, 1.0)).max(0.0);
        let samples = problem.samples();
        let begin = self.setting.begin(samples);
        let simulated = problem.simulate(&model, delay, begin..samples)?;
        let measured = &problem.signals.output[begin..];
        let left = measured.iter().zip(&simulated.y).enumerate();
        let left: Vec<f64> = left
            .map(|(k, (y, simulated))| problem.signals.acting(begin + k, y - simulated))
            .collect();
        let noise = Autoregression::of(&left)?;

        let (q, n) = (layout.outputs(), whole.present.len());
        let mut instruments = vec![vec![0.0_f32; samples - begin]; n];
        pass.run(problem, |k, z, phi| {
            for (column, j) in instruments.iter_mut().zip(&whole.present) {
                let value = match &whole.numerators {
                    Some(b) if *j < q => layout.combined(*j, b, |row| z[row]),
                    _ => phi[*j],
                };
                column[k - begin] = value as f32;
            }
        });
        let backward: Vec<DVector<f64>> = instruments
            .iter()
            .map(|column| {
                let mut lane = pass.design.of_output(pass.form(), 0.0);
                let zeta = column.iter().rev().map(|z| {
                    let trends = lane.output(*z);
                    let of_a = (0..q).map(|i| whole.theta[i] * trends[layout.first + i]);
                    trends[layout.order] + of_a.sum::<f64>()
                });
                noise.inverse(zeta)
            })
            .collect();
        noise.covariance(&backward, &whole.factored)
    }
}
