//! Friction, damping, offset and delay of a force balance by trying, where measured signs tell too
//! little: slow or short motion, whose reversals the noise hides.
//!
//! ```text
//! y = y_0 + b p      p'' = u(t - d h) + c - a p' - phi w(p')      phi = F/|b|
//! ```
//!
//! Four numbers (phi, a, c, d) bend the motion, the gain b and a level y_0 of each part of the
//! record are linear and eliminated (variable projection: Golub and Pereyra, SIAM J. Numer. Anal.
//! 10 (1973)). From the best damping to each phi of a grid Levenberg's and Marquardt's steps lead
//! on. No velocity is measured, and no filter chosen.

use nalgebra::{DMatrix, DVector};

use super::descent::descended;
use crate::estimate::Estimate;
use crate::held_friction::{Force, coulomb};
use crate::identification::model::Identification;
use crate::problem::Problem;
use crate::search::{Choice, Freedom};
use crate::side_by_side::side_by_side;

/// Parts of the record with a level of their own, over which an offset that is slightly wrong does
/// not add up.
const PARTS: usize = 16;

/// Standard deviations by which two estimates may differ by chance.
const CHANCE: f64 = 2.0;

/// Friction as a share of the largest command: halved so many times.
const FRICTIONS: i32 = 8;

/// From a damping to the next of the grid.
const DAMPINGS: f64 = 3.0;

/// Delays behind the best one, in samples, from which the steps lead on once more: short motions
/// leave valleys between them.
const LATER: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// What bends the motion.
#[derive(Debug, Clone, Copy)]
struct Bend {
    /// ln phi, ln a, c/phi, d.
    at: [f64; 4],
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
    problem: &'a Problem<'a>,
    place: usize,
    /// The output without its levels.
    output: DVector<f64>,
}

/// A friction to begin with.
pub(super) struct Start {
    /// Without deviations.
    pub(super) estimate: Estimate,
    pub(super) delay: f64,
    /// Squares that it leaves of the output.
    pub(super) left: f64,
    /// Whether they are noise and no error of a model, which goes on from sample to sample.
    pub(super) white: bool,
}

impl Start {
    /// Lets the standard deviations of a model contain how far away this one is, which simulates
    /// better, where that is more than chance: the most likely one, where it leaves noise alone,
    /// and one with another delay, which the equations are linear in over a sample.
    pub(super) fn contained_in(&self, trial: &Trial, found: &mut Identification) {
        let better = self.left < trial.left_by(&found.estimate, found.delay);
        if !(better && (self.white || found.delay_sigma().is_some())) {
            return;
        }
        let of = &found.estimate;
        let moves = self.estimate.moves_from(of);
        let later = self.delay - found.delay;
        let beyond = |moved: f64, sigma: f64| !(moved.abs() <= CHANCE * sigma);
        let parameters = moves.iter().zip(&of.sigma);
        let far = parameters.into_iter().any(|(m, sigma)| beyond(*m, *sigma));
        let late = found
            .delay_sigma()
            .is_some_and(|sigma| beyond(later, sigma));
        if !(far || late) {
            return;
        }
        if let Some(delay) = &mut found.delay_found {
            delay.widen(later, &moves);
        }
        found.estimate = trial.problem.widened(&found.estimate, &[moves]);
    }
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
        })
    }

    /// What a model leaves of the record; everything where it has no friction.
    pub(super) fn left_by(&self, estimate: &Estimate, delay: f64) -> f64 {
        let (damping, friction) = (estimate.a[1], -estimate.b[self.place][0]);
        let gain = estimate.b[1 - self.place][0];
        if !(damping > 0.0 && friction > 0.0 && gain != 0.0) {
            return f64::INFINITY;
        }
        let phi = friction / gain.abs();
        let at = [
            phi.ln(),
            damping.ln(),
            estimate.constant / gain / phi,
            delay,
        ];
        self.rest(Bend { at }).norm_squared()
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
                let at = |j| [phi.ln(), (slowest * DAMPINGS.powi(j)).ln(), 0.0, delay];
                (0..=dampings).map(|j| Bend { at: at(j) }).collect()
            })
            .collect();
        let best = |row: &Vec<Bend>| {
            let tried = row
                .iter()
                .map(|bend| (self.beside(&force, *bend).rest.norm_squared(), *bend));
            let (_, bend) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(self.refined(bend, freedom))
        };
        let refined = side_by_side(&grid, best);
        let least = |a: &(Bend, f64), b: &(Bend, f64)| a.1.total_cmp(&b.1);
        let best = refined.into_iter().flatten().min_by(least)?;
        let later: Vec<Bend> = match freedom.delay {
            Choice::Given(_) => Vec::new(),
            Choice::Auto => LATER.map(|later| best.0.later_by(later)).to_vec(),
        };
        let refined = side_by_side(&later, |bend| self.refined(*bend, freedom));
        let (bend, _) = refined.into_iter().chain([best]).min_by(least)?;
        self.start(bend)
    }

    /// Where Levenberg's and Marquardt's steps lead, and what is left there.
    fn refined(&self, bend: Bend, freedom: Freedom) -> (Bend, f64) {
        let axes = [
            true,
            true,
            self.problem.structure.constant,
            freedom.delay == Choice::Auto,
        ];
        let [slowest, fastest] = self.dampings().map(f64::ln);
        let within = |mut at: [f64; 4]| {
            at[1] = at[1].clamp(slowest, fastest);
            at[3] = at[3].max(0.0);
            at
        };
        let (at, left) = descended(bend.at, axes, within, |at| self.rest(Bend { at }));
        (Bend { at }, left)
    }

    fn start(&self, bend: Bend) -> Option<Start> {
        let [phi, a, c, delay] = bend.at;
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
            estimate: self.problem.estimate_of(model, theta, &none),
            delay,
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
        let [phi, a, c, _] = bend.at;
        let motion = force.motion(self.problem, c * phi.exp(), [a.exp(), phi.exp()]);
        let mut p = 0.0;
        let places = motion.map(|interval| {
            let here = p;
            p += interval.way;
            here
        });
        places.collect()
    }
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
