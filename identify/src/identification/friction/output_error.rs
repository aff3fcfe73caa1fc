//! The most likely model with friction, that whose motion leaves least of the output, with its
//! deviations.
//!
//! ```text
//! x = (theta, d)    r(x) = y - motion(x), levels of the parts taken out    J = -dr/dx
//! P = (J'J)^-1 S (J'J)^-1      S of the scores J'r of the parts, or of noise like r
//! ```
//!
//! The motion is bent where it reverses, and where it rests only what would end the rest is seen:
//! J is made of differences as large as the deviations, along directions that do not depend on each
//! other.
//!
//! Known as: output-error method (Ljung, System Identification, 1999) with a sandwich covariance.

use nalgebra::{DMatrix, DVector};

use super::settle::with_signs_of;
use super::start::{Bend, PARTS, Start, Trial};
use crate::delay_choice::LONGEST_DELAY;
use crate::free_run::FreeRun;
use crate::identification::model::{Friction, Identification, Way};
use crate::identification::recursion::{middle, recursive_errors};
use crate::instruments::DelayFound;
use crate::instruments::autoregression::of_noise;
use crate::instruments::factored::Factored;
use crate::instruments::later::reach;
use crate::instruments::spread::{Score, larger, spread};
use crate::problem::Problem;
use crate::run::{PredictionErrors, Trace};
use crate::search::{Choice, Freedom};

/// Repetitions until differences are as large as the deviations: each halves the logarithm of what
/// they are wrong by, so that a thousand becomes a hundredth.
const REPETITIONS: usize = 10;

/// Differences over which nothing changes are made longer by this at most at once.
const FLAT: f64 = 100.0;

/// Differences at most, as a share of damping and friction, which are positive.
const POSSIBLE: f64 = 0.9;

/// Differences to begin with, as a share of a parameter, and of a delay in samples.
const SMALL: f64 = 1e-3;

/// A friction found by trying, with what it is found in.
pub(super) struct MostLikely<'a> {
    pub(super) trial: &'a Trial<'a>,
    pub(super) start: &'a Start,
    pub(super) friction: Friction,
    pub(super) freedom: Freedom,
    pub(super) trace_points: usize,
}

impl MostLikely<'_> {
    /// The model that leaves least of the output, from this friction or from that of another model;
    /// `None` where it leaves more than noise.
    pub(super) fn identified(&self, other: Option<&Identification>) -> Option<Identification> {
        let trial = self.trial;
        let problem = trial.problem;
        let from = other.and_then(|other| trial.bend(&other.estimate, other.delay));
        let from: Vec<Bend> = from.into_iter().chain([self.start.bend]).collect();
        let found = trial
            .likeliest(&from, self.freedom)
            .filter(|found| found.white)?;
        let free = self.freedom.delay == Choice::Auto;
        let unknowns = Unknowns {
            trial,
            found: &found,
            free,
        };
        let Varies { covariance, parts } = unknowns.vary()?;
        let theta = found.estimate.theta.clone();
        let p = theta.len();
        let of_theta = covariance.view((0, 0), (p, p)).into_owned();
        let delay_found = free.then(|| DelayFound {
            shift: 0.0,
            sigma: covariance[(p, p)].sqrt(),
            with: (0..p).map(|i| covariance[(i, p)]).collect(),
            reach: reach(problem, &problem.polynomials(&theta)),
        });
        let (free_run, held_out) = self.free_run(&found);
        let (pole, errors, trace) = match other {
            Some(other) => (other.pole, other.errors, other.trace.clone()),
            None => self.recursive(&found)?,
        };
        Some(Identification {
            way: Way::OutputError,
            pole,
            own_filter: other.and_then(|other| other.own_filter.clone()),
            filter_shifts: None,
            delay: found.delay,
            delay_at_end: found.delay >= LONGEST_DELAY as f64,
            delay_alike: free.then(|| [found.delay.floor() as usize, found.delay.ceil() as usize]),
            delay_found: delay_found.or_else(|| other?.delay_found.clone()),
            delay_imitated: None,
            poor_input: other.and_then(|other| other.poor_input),
            friction: self.friction,
            estimate: problem.estimate_of(problem.polynomials(&theta), theta, &of_theta),
            effective_blocks: Some(parts),
            least_squares: None,
            errors,
            free_run,
            held_out,
            trace,
        })
    }

    /// The second half by the model of the first one, which is found from that of the whole record
    /// on, and whether there is such a model.
    fn free_run(&self, found: &Start) -> (Option<FreeRun>, bool) {
        let half = self.of_half(found);
        let held_out = half.is_some();
        let half = half.as_ref().unwrap_or(found);
        let problem = self.trial.problem;
        let n = problem.samples();
        let free_run = with_signs_of(problem, (&half.estimate, half.delay), |own| {
            own.free_run(&half.estimate, half.delay, n / 2..n)
        });
        (free_run, held_out)
    }

    fn of_half(&self, found: &Start) -> Option<Start> {
        let problem = self.trial.problem;
        let half = problem.signals.part(0..problem.samples() / 2);
        let half = Problem::new(&half, problem.structure, problem.options).ok()?;
        let trial = Trial::of(&half)?;
        trial.likeliest(&[found.bend], self.freedom)
    }

    /// What the recursion makes of this friction behind the middle one of all filters.
    fn recursive(&self, found: &Start) -> Option<(Option<f64>, PredictionErrors, Trace)> {
        let own = (&found.estimate, found.delay);
        with_signs_of(self.trial.problem, own, |problem| {
            let tuning = middle(problem, found.delay);
            let errors = recursive_errors(problem, tuning, self.trace_points);
            let (errors, trace) = errors.unwrap_or_default();
            Some((tuning.pole, errors, trace))
        })
    }
}

/// The unknowns of a motion: theta, the delay where it is free, and the velocity at the start.
struct Unknowns<'a> {
    trial: &'a Trial<'a>,
    found: &'a Start,
    free: bool,
}

/// Covariance of the unknowns, and the independent parts that it rests on.
struct Varies {
    covariance: DMatrix<f64>,
    parts: f64,
}

impl Unknowns<'_> {
    fn rest(&self, x: &DVector<f64>) -> Option<DVector<f64>> {
        let n = x.len();
        let p = n - 1 - usize::from(self.free);
        let delay = if self.free {
            x[p].abs()
        } else {
            self.found.delay
        };
        self.trial.rest_of(&x.as_slice()[..p], delay, x[n - 1])
    }

    /// How much an estimate varies.
    fn vary(&self) -> Option<Varies> {
        let of = &self.found.estimate;
        let delay = self.free.then_some(self.found.delay);
        let all = of.theta.iter().copied().chain(delay);
        let all = all.chain([self.found.velocity]);
        let x = DVector::from_vec(all.collect());
        let left = self.rest(&x)?;
        let n = x.len();
        let mut size = x.map(|value| SMALL * value.abs());
        let gain = of.b[1 - self.trial.place][0].abs();
        if self.trial.problem.structure.constant {
            size[of.theta.len() - 1] = SMALL * gain;
        }
        if self.free {
            size[n - 2] = SMALL;
        }
        size[n - 1] = gain * self.trial.fastest;
        let mut steps = DMatrix::from_diagonal(&size);
        let mut varies = None;
        for _ in 0..REPETITIONS {
            self.shorten(&x, &mut steps);
            let slope = self.slope(&x, &left, &steps)?;
            let (covariance, parts) = covariance(&slope, &left)?;
            varies = Some(Varies {
                covariance: &steps * &covariance * steps.transpose(),
                parts,
            });
            let eigen = covariance.symmetric_eigen();
            let lengths = eigen
                .eigenvalues
                .map(|v| v.max(f64::MIN_POSITIVE).powf(0.25));
            steps = steps * eigen.eigenvectors * DMatrix::from_diagonal(&lengths);
        }
        varies
    }

    /// Steps no longer than damping and friction stay what they are.
    fn shorten(&self, x: &DVector<f64>, steps: &mut DMatrix<f64>) {
        for mut step in steps.column_iter_mut() {
            let beyond = [0, 1 + self.trial.place].map(|j| (step[j] / (POSSIBLE * x[j])).abs());
            step /= beyond.into_iter().fold(1.0, f64::max);
        }
    }

    /// What is less of the output by these steps.
    fn slope(
        &self,
        x: &DVector<f64>,
        left: &DVector<f64>,
        steps: &DMatrix<f64>,
    ) -> Option<DMatrix<f64>> {
        let columns = steps.column_iter().map(|step| {
            let ahead = self.rest(&(x + step)).map(|ahead| left - ahead);
            let behind = self.rest(&(x - step)).map(|behind| behind - left);
            let both = [ahead, behind].into_iter().flatten();
            both.min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))
        });
        Some(DMatrix::from_columns(&columns.collect::<Option<Vec<_>>>()?))
    }
}

/// Covariance of the weights of columns, and the independent parts that it rests on.
fn covariance(slope: &DMatrix<f64>, left: &DVector<f64>) -> Option<(DMatrix<f64>, f64)> {
    let n = slope.ncols();
    let variance = left.norm_squared() / left.len() as f64;
    let least = DMatrix::identity(n, n) * (variance / (FLAT * FLAT));
    let factored = Factored::new(&(slope.tr_mul(slope) + &least))?;
    let part = left.len().div_ceil(PARTS).max(1);
    let scores: Vec<Score> = (0..left.len())
        .step_by(part)
        .map(|first| {
            let samples = part.min(left.len() - first);
            let slope = slope.rows(first, samples);
            Score {
                matrix: slope.tr_mul(&slope),
                left: slope.tr_mul(&left.rows(first, samples)),
            }
        })
        .collect();
    let (blocks, parts) = spread(&factored, &scores, n)?;
    let columns: Vec<DVector<f64>> = slope.column_iter().map(|c| c.into_owned()).collect();
    let noise = of_noise(left.as_slice(), &columns, &factored);
    // What the least adds is noise of its own.
    let of_least = factored.sandwich(&(variance * least))?;
    let blocks = blocks + &of_least;
    // The larger one in each direction: parts are few, and noise may change between them.
    let both = noise.and_then(|noise| larger(&blocks, f64::INFINITY, &(noise + of_least)));
    Some((both.unwrap_or(blocks), parts))
}
