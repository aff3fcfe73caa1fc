//! Instrumental variables over a whole record: the inputs filtered twice, combined after the sums.
//!
//! Known as: instrumental variables with a fixed auxiliary denominator (Young 1981; Garnier and
//! Wang 2008), with a cluster-robust covariance over blocks of time.
//!
//! ```text
//! q = m - integrators    A_z fixed, stable, of order q    A_f the filter of the trends
//! x_cj = s^j / (A_f A_z) u_c                  j = 0 .. q + n_b - 2
//! z = (x_cj of all inputs ; the regressors)   sum z [phi' psi], block by block
//! row of a_i := - sum_c sum_j b_cj (row of x_c,i-integrators+j)       theta = (Z'Phi)^-1 Z'psi
//! ```
//!
//! The noise of the output is in the regressors of a_i, not in what the inputs alone give: the
//! estimate is free of bias whatever the noise. Behind an integrator `s^i y = s^(i-1) v` and
//! `v = B/A' u`: nothing is integrated, nothing drifts. The equations are linear in the rows of the
//! sums, so the numerators b may change afterwards for all past samples. The m coefficients of the
//! initial state are regressors, too: a record may begin anywhere, and filters may be slow.
//!
//! All trends are the core's; the sums are in f64. Cost: (r + p) (p + 1) multiplications per sample
//! and pass for r twice filtered rows and p regressors, two or three passes.

pub(crate) mod autoregression;
mod auxiliary;
pub(crate) mod every_delay;
pub(crate) mod factored;
mod free_delay;
mod lanes;
pub(crate) mod later;
mod layout;
mod numerators;
mod output_noise;
mod pass;
mod rounding;
mod solve;
pub(crate) mod spread;
mod sums;
mod within;

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, Weakness};
use crate::estimate::Estimate;
use crate::polynomials::{Pole, Polynomials, from_roots, roots};
use crate::problem::Problem;
use crate::tuning::FASTEST;

use auxiliary::near;
pub use later::DelayFound;
use layout::Setting;
use rounding::rounding_of_delay;
pub use solve::Method;
use solve::Whole;
pub(crate) use sums::BLOCKS;
use sums::Sums;
pub(crate) use within::share;

/// Folds of the comparison; each is two blocks of the sums.
pub const FOLDS: usize = 8;

/// Passes of a comparison: one with a rough auxiliary denominator, one with that of its model.
const PASSES: usize = 2;

/// Further passes at most until the auxiliary denominator and the numerators are those of the
/// estimate.
const FURTHER_PASSES: usize = 4;

/// Numerators that are wrong by less than this need no further pass: the rounding of the trends.
const NEGLIGIBLE: f64 = f32::EPSILON as f64;

/// Auxiliary denominators that differ by less than this serve as well.
const ALIKE: f64 = 0.02;

/// A filter and a delay over a record, with the sums that answer every question about them.
pub struct Fit<'a> {
    problem: &'a Problem<'a>,
    setting: Setting,
    sums: Sums,
    method: Method,
}

/// A model with its standard deviations from the record itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The model; its covariance is not finite where there were too few blocks.
    pub estimate: Estimate,
    /// Blocks that the standard deviations rest on, as an effective number of at most 16.
    pub effective_blocks: f64,
    /// The delay where it is an unknown.
    pub delay: Option<DelayFound>,
}

impl<'a> Fit<'a> {
    /// The sums behind the filter polynomial `filter` (f_0 .. f_{m-1}) with inputs `delay` samples
    /// late.
    ///
    /// # Errors
    /// The core's refusal of the filter; [`Error::CannotCarry`] where the equations are singular.
    pub fn new(
        problem: &'a Problem<'a>,
        filter: &[f64],
        delay: f64,
        method: Method,
    ) -> Result<Self, Error> {
        let q = problem.structure.order - usize::from(problem.structure.integrator);
        let rough = roots(filter)
            .map(|roots| from_roots(&roots[roots.len() - q..]))
            .unwrap_or_default();
        let mut setting = Setting {
            filter: filter.to_vec(),
            model: filter.to_vec(),
            auxiliary: rough,
            delay,
            later: None,
        };
        if let Some(roots) = roots(&setting.auxiliary) {
            setting.auxiliary = problem.within_reach(&roots);
        }
        let mut fit = Self {
            problem,
            sums: Sums::of(problem, &setting)?,
            setting,
            method,
        };
        fit.repeat(PASSES - 1)?;
        match fit.polynomials(method) {
            Some(_) => Ok(fit),
            None => Err(problem.cannot_carry(Weakness::Singular)),
        }
    }

    /// The same with further passes, until auxiliary denominator and numerators are those of the
    /// estimate.
    ///
    /// # Errors
    /// As [`Fit::new`].
    pub fn refined(mut self) -> Result<Self, Error> {
        self.repeat(FURTHER_PASSES)?;
        Ok(self)
    }

    /// At most so many passes with the auxiliary denominator and the numerators of the model
    /// before.
    fn repeat(&mut self, passes: usize) -> Result<(), Error> {
        for _ in 0..passes {
            let Some(next) = self.next_setting() else {
                break;
            };
            self.sums = Sums::of(self.problem, &next)?;
            self.setting = next;
        }
        Ok(())
    }

    /// The setting that the model found asks for; `None` where it is about the present one.
    fn next_setting(&self) -> Option<Setting> {
        let (problem, dt) = (self.problem, self.problem.signals.dt);
        let model = self
            .polynomials(self.method)
            .or_else(|| self.polynomials(Method::LeastSquares))?;
        let poles = model.poles(usize::from(problem.structure.integrator))?;
        let size = |(re, im): &Pole| re.hypot(*im) * dt;
        let largest = |poles: &[Pole]| poles.iter().map(size).fold(0.0, f64::max);
        let fastest = largest(&poles);
        // Numerators of another denominator, the filter at first, are wrong by its distance times
        // this, f (1 - f)/2 where the input changes within a sample.
        let farthest = largest(&roots(&self.setting.filter)?).max(fastest);
        let within = self.setting.delay.fract() != 0.0;
        let of_distance = farthest * if within { 0.125 } else { farthest / 12.0 };
        let exact = of_distance > NEGLIGIBLE && fastest < FASTEST;
        let next = Setting {
            auxiliary: problem.within_reach(&poles),
            model: match exact {
                true => model.a,
                false => self.setting.filter.clone(),
            },
            ..self.setting.clone()
        };
        let settled = near(&next.auxiliary, &self.setting.auxiliary, ALIKE)
            && near(&next.model, &self.setting.model, NEGLIGIBLE / of_distance);
        (!settled && (exact || self.method == Method::Instruments)).then_some(next)
    }

    /// How its equations are solved.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Delay in samples.
    pub fn delay(&self) -> f64 {
        self.setting.delay
    }

    /// f_0 .. f_{m-1} of the filter.
    pub fn filter(&self) -> &[f64] {
        &self.setting.filter
    }

    fn polynomials(&self, method: Method) -> Option<Polynomials> {
        self.in_s_plane(&self.sums.solve(method, |_| false)?)
            .map(|(model, _)| model)
    }

    /// The model of the whole record.
    pub fn model(&self) -> Option<Polynomials> {
        self.polynomials(self.method)
    }

    /// Parameters of the s plane without one of the [`FOLDS`].
    pub fn without_fold(&self, fold: usize) -> Option<(Polynomials, Vec<f64>)> {
        let each = BLOCKS / FOLDS;
        let theta = self.sums.solve(self.method, |block| block / each == fold)?;
        self.in_s_plane(&theta)
    }

    /// Parameters of the plane of the trends as a model, and as theta.
    fn in_s_plane(&self, theta: &[f64]) -> Option<(Polynomials, Vec<f64>)> {
        let layout = &self.sums.layout;
        let q = layout.outputs();
        let mut found = vec![0.0; layout.order];
        found[layout.first..].copy_from_slice(&theta[..q]);
        let zeros = layout.terms.iter().any(|terms| *terms > 1);
        let design = &self.sums.design;
        let (a, numerator) = design.to_s_plane(&found, layout.first, zeros)?;
        let mut mapped = a[layout.first..].to_vec();
        mapped.extend(theta[q..].iter().map(|b| b * numerator));
        if layout.constant && layout.first == 0 {
            // A (y - r) = B u + d' is A y = B u + d' + a_0 r.
            mapped[theta.len() - 1] += a[0] * self.sums.reference;
        }
        Some((self.problem.polynomials(&mapped), mapped))
    }

    /// The model of the whole record with its standard deviations, by the blocks alone.
    ///
    /// # Errors
    /// [`Error::CannotCarry`] where a parameter is not finite.
    pub fn found(&self) -> Result<Found, Error> {
        self.found_with(|_| None)
    }

    /// The same with standard deviations that contain what the noise of the output makes of it,
    /// also where all information is in one block. Cost: two passes more.
    ///
    /// # Errors
    /// As [`Fit::found`].
    pub fn found_behind_noise(&self) -> Result<Found, Error> {
        self.found_with(|whole| self.of_output_noise(whole))
    }

    fn found_with(
        &self,
        of_noise: impl FnOnce(&Whole) -> Option<DMatrix<f64>>,
    ) -> Result<Found, Error> {
        let weak = |weakness| self.problem.cannot_carry(weakness);
        let solution = self.sums.solve_whole(self.method, of_noise);
        let solution = solution.ok_or_else(|| weak(Weakness::Singular))?;
        let (model, theta) = self
            .in_s_plane(&solution.theta)
            .ok_or_else(|| weak(Weakness::NotFinite))?;
        let p = theta.len();
        let mut delay = solution.delay;
        let covariance = match &solution.covariance {
            Some(covariance) => {
                let slope = self.slope(&solution.theta, &theta, covariance);
                if let Some(delay) = &mut delay {
                    delay.reach = later::reach(self.problem, &model);
                    let rounding = rounding_of_delay(&self.setting.filter, self.problem.signals.dt);
                    delay.sigma = delay.sigma.hypot(rounding);
                    let with = DVector::from_column_slice(&delay.with);
                    delay.with = (&slope * with).as_slice().to_vec();
                }
                &slope * covariance * slope.transpose()
            }
            None => DMatrix::from_element(p, p, f64::NAN),
        };
        Ok(Found {
            estimate: self.problem.estimate_of(model, theta, &covariance),
            effective_blocks: solution.effective_blocks,
            delay,
        })
    }

    /// Derivatives of theta in the s plane by theta in the plane of the trends, by differences of a
    /// third of sigma.
    fn slope(&self, theta: &[f64], mapped: &[f64], covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let mut slope = DMatrix::identity(theta.len(), theta.len());
        for j in 0..theta.len() {
            let step = 0.3 * covariance[(j, j)].sqrt() + 1e-3 * theta[j].abs();
            let mut moved = theta.to_vec();
            moved[j] += step;
            let Some((_, moved)) = self.in_s_plane(&moved).filter(|_| step > 0.0) else {
                continue;
            };
            for i in 0..mapped.len() {
                slope[(i, j)] = (moved[i] - mapped[i]) / step;
            }
        }
        slope
    }
}
