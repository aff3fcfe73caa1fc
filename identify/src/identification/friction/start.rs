//! Friction, damping, offset and delay of a force balance by trying, where measured signs tell too
//! little: slow or short motion, whose reversals the noise hides.
//!
//! ```text
//! y = y_0 + b p      p'' = u(t - d h) + c - a p' - phi w(p')      phi = F/|b|
//! ```
//!
//! Four numbers (phi, a, c, d) bend the motion and so does p'(0), which a record that begins in
//! motion has; the gain b and a level y_0 of each part of the record are linear and eliminated
//! (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973)). From the best damping
//! to each phi of a grid Levenberg's and Marquardt's steps lead on. No velocity is measured, and no
//! filter chosen.

use nalgebra::{DMatrix, DVector};

use super::descent::{AXES, descended};
use crate::estimate::Estimate;
use crate::held_friction::{Force, Interval, coulomb};
use crate::problem::Problem;
use crate::search::{Choice, Freedom};
use crate::side_by_side::side_by_side;

/// Share of the squares that a step has to take away in the search.
const WORTH: f64 = 1e-4;

/// The same in the end, in mean squares: a standard deviation of one parameter leaves one more.
const WORTH_IN_THE_END: f64 = 0.01;

/// Parts of the record with a level of their own, over which an offset that is slightly wrong does
/// not add up.
pub(super) const PARTS: usize = 16;

/// Friction as a share of the largest command: halved so many times.
const FRICTIONS: i32 = 8;

/// From a damping to the next of the grid.
const DAMPINGS: f64 = 3.0;

/// Delays behind the best one, in samples, from which the steps lead on once more: short motions
/// leave valleys between them.
const LATER: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// What bends the motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bend {
    /// ln phi, ln a, c/phi, d, and the velocity at the start over that of a sample.
    at: [f64; AXES],
}

impl Bend {
    fn later_by(mut self, samples: f64) -> Self {
        self.at[3] += samples;
        self
    }
}

/// A motion beside the record.
struct Beside {
    /// b.
    gain: f64,
    /// What is left of the record.
    rest: DVector<f64>,
}

/// A record that is simulated with many frictions.
pub(super) struct Trial<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) place: usize,
    /// The output without its levels.
    output: DVector<f64>,
    /// What the largest command makes of the velocity in a sample, over b.
    pub(super) fastest: f64,
}

/// A friction to begin with.
pub(super) struct Start {
    pub(super) bend: Bend,
    /// Without deviations.
    pub(super) estimate: Estimate,
    pub(super) delay: f64,
    /// Velocity at the start.
    pub(super) velocity: f64,
    /// Squares that it leaves of the output.
    pub(super) left: f64,
    /// Whether they are noise and no error of a model, which goes on from sample to sample.
    pub(super) white: bool,
}

impl<'a> Trial<'a> {
    /// Of a force balance with one input beside its friction; `None` for others.
    pub(super) fn of(problem: &'a Problem<'a>) -> Option<Self> {
        let structure = problem.structure;
        let balance = structure.integrator && structure.order == 2 && structure.zeros == 0;
        let place = coulomb(problem)?;
        let one = problem.signals.inputs.len() == 2;
        (balance && one).then(|| Self {
            problem,
            place,
            output: levelled(problem.signals.output.to_vec()),
            fastest: Force::of(problem, |c| (c != place).then_some(1.0), 0.0).largest()
                * problem.signals.dt,
        })
    }

    /// What a model leaves of the record from rest on; everything where it has no friction.
    pub(super) fn left_by(&self, estimate: &Estimate, delay: f64) -> f64 {
        let bend = self.bend(estimate, delay);
        bend.map_or(f64::INFINITY, |bend| self.rest(bend).norm_squared())
    }

    /// What bends the motion of a model from rest on; `None` where it has no friction.
    pub(super) fn bend(&self, estimate: &Estimate, delay: f64) -> Option<Bend> {
        let (damping, friction) = (estimate.a[1], -estimate.b[self.place][0]);
        let gain = estimate.b[1 - self.place][0];
        if !(damping > 0.0 && friction > 0.0 && gain != 0.0) {
            return None;
        }
        let phi = friction / gain.abs();
        let at = [
            phi.ln(),
            damping.ln(),
            estimate.constant / gain / phi,
            delay,
            0.0,
        ];
        Some(Bend { at })
    }

    /// What a model leaves of the record; `None` where it has no friction or no damping.
    pub(super) fn rest_of(&self, theta: &[f64], delay: f64, velocity: f64) -> Option<DVector<f64>> {
        let model = self.problem.polynomials(theta);
        let (damping, friction) = (model.a[1], -model.b[self.place][0]);
        if !(damping > 0.0 && friction > 0.0) {
            return None;
        }
        let force = Force::of(
            self.problem,
            |c| (c != self.place).then(|| model.b[c][0]),
            delay,
        );
        let motion = force.motion(self.problem, velocity, model.constant, [damping, friction]);
        Some(&self.output - levelled(places(motion)))
    }

    /// The one that leaves least of the record among those that the steps lead to from others.
    pub(super) fn likeliest(&self, from: &[Bend], freedom: Freedom) -> Option<Start> {
        let worth = WORTH_IN_THE_END / self.output.len() as f64;
        let refined = side_by_side(from, |bend| self.refined(*bend, freedom, worth));
        let (bend, _) = refined.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        self.start(bend)
    }

    /// The friction that leaves least of the record.
    pub(super) fn best(&self, freedom: Freedom) -> Option<Start> {
        let delay = match freedom.delay {
            Choice::Given(delay) => delay as f64,
            Choice::Auto => 0.0,
        };
        let force = self.force(delay);
        let largest = force.largest();
        let [slowest, fastest] = self.dampings();
        let dampings = (fastest / slowest).log(DAMPINGS) as i32;
        let grid: Vec<Vec<Bend>> = (1..=FRICTIONS)
            .map(|i| {
                let phi: f64 = largest * 0.5_f64.powi(i);
                let at = |j| [phi.ln(), (slowest * DAMPINGS.powi(j)).ln(), 0.0, delay, 0.0];
                (0..=dampings).map(|j| Bend { at: at(j) }).collect()
            })
            .collect();
        let best = |row: &Vec<Bend>| {
            let tried = row
                .iter()
                .map(|bend| (self.beside(&force, *bend).rest.norm_squared(), *bend));
            let (_, bend) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(self.refined(bend, freedom, WORTH))
        };
        let refined = side_by_side(&grid, best);
        let least = |a: &(Bend, f64), b: &(Bend, f64)| a.1.total_cmp(&b.1);
        let best = refined.into_iter().flatten().min_by(least)?;
        let later: Vec<Bend> = match freedom.delay {
            Choice::Given(_) => Vec::new(),
            Choice::Auto => LATER.map(|later| best.0.later_by(later)).to_vec(),
        };
        let refined = side_by_side(&later, |bend| self.refined(*bend, freedom, WORTH));
        let (bend, _) = refined.into_iter().chain([best]).min_by(least)?;
        self.start(bend)
    }

    /// Where Levenberg's and Marquardt's steps lead, and what is left there.
    fn refined(&self, bend: Bend, freedom: Freedom, worth: f64) -> (Bend, f64) {
        let axes = [
            true,
            true,
            self.problem.structure.constant,
            freedom.delay == Choice::Auto,
            true,
        ];
        let [slowest, fastest] = self.dampings().map(f64::ln);
        let within = |mut at: [f64; AXES]| {
            at[1] = at[1].clamp(slowest, fastest);
            at[3] = at[3].max(0.0);
            at
        };
        let (at, left) = descended(bend.at, axes, worth, within, |at| self.rest(Bend { at }));
        (Bend { at }, left)
    }

    fn start(&self, bend: Bend) -> Option<Start> {
        let [phi, a, c, delay, velocity] = bend.at;
        let Beside { gain, rest } = self.beside(&self.force(delay), bend);
        if !(gain != 0.0 && gain.is_finite()) {
            return None;
        }
        let phi = phi.exp();
        let mut theta = vec![a.exp(), gain, gain];
        theta[1 + self.place] = -phi * gain.abs();
        if self.problem.structure.constant {
            theta.push(c * phi * gain);
        }
        let none = DMatrix::zeros(theta.len(), theta.len());
        let model = self.problem.polynomials(&theta);
        Some(Start {
            bend,
            estimate: self.problem.estimate_of(model, theta, &none),
            delay,
            velocity: velocity * self.fastest * gain,
            left: rest.norm_squared(),
            white: is_white(&rest),
        })
    }

    /// The slowest damping that the record shows and the fastest one that its samples do.
    fn dampings(&self) -> [f64; 2] {
        let dt = self.problem.signals.dt;
        [1.0 / (self.problem.samples() as f64 * dt), 1.0 / dt]
    }

    fn force(&self, delay: f64) -> Force {
        Force::of(self.problem, |c| (c != self.place).then_some(1.0), delay)
    }

    /// The motion beside the record, with the gain and the levels that leave least.
    fn beside(&self, force: &Force, bend: Bend) -> Beside {
        let p = levelled(self.motion(force, bend));
        let (yp, pp) = (self.output.dot(&p), p.dot(&p));
        let gain = if pp > 0.0 { yp / pp } else { 0.0 };
        let rest = &self.output - gain * p;
        Beside { gain, rest }
    }

    /// What is left of the record beside the motion.
    fn rest(&self, bend: Bend) -> DVector<f64> {
        self.beside(&self.force(bend.at[3]), bend).rest
    }

    /// p.
    fn motion(&self, force: &Force, bend: Bend) -> Vec<f64> {
        let [phi, a, c, _, velocity] = bend.at;
        let start = velocity * self.fastest;
        let motion = force.motion(self.problem, start, c * phi.exp(), [a.exp(), phi.exp()]);
        places(motion)
    }
}

/// Places at the samples, from zero on.
fn places(motion: impl Iterator<Item = Interval>) -> Vec<f64> {
    let mut p = 0.0;
    let places = motion.map(|interval| {
        let here = p;
        p += interval.way;
        here
    });
    places.collect()
}

/// Whether the correlation of neighbours is below a half, by the squares of their differences (von
/// Neumann, Annals of Mathematical Statistics 12 (1941)): twice the squares in white noise.
fn is_white(rest: &DVector<f64>) -> bool {
    let pairs = rest.as_slice().windows(2);
    let differences: f64 = pairs.map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    differences > rest.norm_squared()
}

/// A signal with the mean of each part of the record taken out.
fn levelled(mut signal: Vec<f64>) -> DVector<f64> {
    let part = signal.len().div_ceil(PARTS).max(1);
    for part in signal.chunks_mut(part) {
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        part.iter_mut().for_each(|value| *value -= mean);
    }
    DVector::from_vec(signal)
}
