//! From the sums to an estimate, in steps that fit a sample each.

use crate::identifier::Identifier;
use crate::instruments::blocks::BLOCKS;
use crate::instruments::found::{Found, Way};
use crate::instruments::layout::Layout;
use crate::instruments::products::Products;
use crate::instruments::solve::Factored;
use crate::instruments::spread::Spread;
use crate::instruments::sums::Instruments;
use crate::instruments::weakness::is_weak;
use crate::math::larger;
use crate::math::matrix::{Matrix, add_square};
use crate::trends::TrendOperator;

/// Rounding of a sum, relative to its largest term: that of 128 rows and of 128 such sums, 2^-24
/// each, adds up by chance to `2 sqrt(128) 2^-24`, a little less than this.
const ROUNDING: f32 = 2.0 * f32::EPSILON * 8.0;

/// Solutions with the numerators of the one before.
const REPETITIONS: usize = 3;

/// An estimate by instruments under way: 16 steps of at most a block each, 3 solutions, 16 scores,
/// the covariance.
///
/// # Examples
/// ```
/// use trendid::instruments::{self, Instrumented, Reading};
/// use trendid::trends::{FilteredTrends, Scheme};
/// use trendid::{Config, Structure};
/// const ROWS: usize = instruments::rows(&Structure::<1, 2, 1>::FULL);
/// let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0)?;
/// let config = Config::new(Structure::<1, 2, 1>::FULL, 20.0, [1.0], 1.0);
/// let mut lag: Instrumented<_, 1, 2, 1, ROWS> = Instrumented::try_new(&config, trends)?;
/// let mut reading = Reading::new();
/// let (mut y, mut found) = (0.0, None);
/// for k in 0..1000 {
///     let u = if k % 200 < 100 { 1.0 } else { 0.0 };
///     let _ = lag.update(u, y); // every sample ...
///     if k >= 900 && found.is_none() {
///         found = reading.step(&mut lag); // ... and in some of them a step of the reading
///     }
///     y += (1.0 - (-0.01_f32).exp()) * (u - y); // y' = 10 (u - y)
/// }
/// let [a0, b0] = found.unwrap().estimate.theta();
/// assert!((a0 - 10.0).abs() < 0.01 && (b0 - 10.0).abs() < 0.01);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Reading<const N: usize, const R: usize> {
    step: usize,
    /// Changes of the blocks when it began.
    changes: u32,
    total: Products<N, R>,
    theta: [f32; N],
    /// Numerators that combined the rows of `factored`.
    combined: [f32; N],
    /// Parameters that are not solved for: known ones, and those of which nothing is left in the
    /// sums.
    fixed: [bool; N],
    factored: Option<Factored<N>>,
    spread: Spread<N>,
    /// Of the constant, by the recursion.
    constant_variance: f32,
}

impl<const N: usize, const R: usize> Default for Reading<N, R> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize, const R: usize> Reading<N, R> {
    /// A reading that begins with its first step.
    pub const fn new() -> Self {
        Self {
            step: 0,
            changes: 0,
            total: Products::ZERO,
            theta: [0.0; N],
            combined: [0.0; N],
            fixed: [false; N],
            factored: None,
            spread: Spread::ZERO,
            constant_variance: 0.0,
        }
    }

    pub(super) fn step_of<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize>(
        &mut self,
        instruments: &Instruments<M, N, I, R>,
        identifier: &Identifier<T, M, N, I, D>,
    ) -> Option<Found<M, N, I>> {
        const SCORES: usize = BLOCKS + REPETITIONS;
        let blocks = &instruments.blocks;
        if self.step == 0 || blocks.changes != self.changes {
            *self = Self::new();
            self.changes = blocks.changes;
        }
        let step = self.step;
        self.step += 1;
        if step < BLOCKS {
            if let Some((sums, weight, _)) = blocks.block(step) {
                self.total.add(1.0, sums, weight);
            }
            return None;
        }
        if step < SCORES {
            if step == BLOCKS {
                self.total.add(1.0, blocks.fresh(), 1.0);
                self.begin(identifier);
            }
            if let Err(way) = self.solve(&instruments.layout) {
                return Some(self.recursion(identifier, way));
            }
            return None;
        }
        if step < SCORES + BLOCKS {
            if let Some((sums, weight, follows)) = blocks.block(step - SCORES) {
                self.add_score(&instruments.layout, sums, weight, follows);
            }
            return None;
        }
        Some(self.finish(instruments, identifier))
    }

    /// The estimate of the recursion instead, and the end of this reading.
    fn recursion<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize>(
        &mut self,
        identifier: &Identifier<T, M, N, I, D>,
        way: Way,
    ) -> Found<M, N, I> {
        self.step = 0;
        Found {
            estimate: identifier.estimate(),
            way,
            effective_blocks: 0.0,
        }
    }

    /// Begins with the parameters of the recursion.
    fn begin<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize>(
        &mut self,
        identifier: &Identifier<T, M, N, I, D>,
    ) {
        let read_out = identifier.read_out();
        self.theta = read_out.normalised_theta();
        self.fixed = read_out.known();
        self.constant_variance = read_out.constant_variance();
        for j in 0..N {
            let mut seen = 0.0_f32;
            for row in &self.total.phi {
                seen = seen.max(row[j].abs());
            }
            self.fixed[j] |= !(seen > f32::MIN_POSITIVE);
        }
    }

    /// The combined equations of some sums with the present numerators: M, and what is left of the
    /// right-hand side.
    fn equations<const M: usize, const I: usize>(
        &self,
        layout: &Layout<M, N, I>,
        sums: &Products<N, R>,
        numerators: &[f32; N],
    ) -> (Matrix<N>, [f32; N]) {
        let mut matrix = [[0.0; N]; N];
        let mut right = [0.0; N];
        let lines = matrix.iter_mut().zip(&mut right).zip(&self.fixed);
        for (i, ((line, value), fixed)) in lines.enumerate() {
            if *fixed {
                continue;
            }
            layout.combine(i, numerators, |row, weight| {
                let (Some(phi), Some(psi)) = (sums.phi.get(row), sums.psi.get(row)) else {
                    return;
                };
                for (entry, phi) in line.iter_mut().zip(phi) {
                    *entry += weight * phi;
                }
                *value += weight * psi;
            });
        }
        (matrix, right)
    }

    /// theta with the numerators of the theta before.
    fn solve<const M: usize, const I: usize>(
        &mut self,
        layout: &Layout<M, N, I>,
    ) -> Result<(), Way> {
        let numerators = self.theta;
        let (mut matrix, mut right) = self.equations(layout, &self.total, &numerators);
        for j in 0..N {
            if !self.fixed[j] {
                continue;
            }
            for i in 0..N {
                right[i] -= matrix[i][j] * self.theta[j];
                matrix[i][j] = 0.0;
            }
            matrix[j][j] = 1.0;
            right[j] = self.theta[j];
        }
        let factored = Factored::new(&matrix).ok_or(Way::WeakInstruments)?;
        let theta = factored.solve_refined(&matrix, &right);
        if !theta.iter().all(|value| value.is_finite()) {
            return Err(Way::WeakInstruments);
        }
        self.theta = theta;
        self.combined = numerators;
        self.factored = Some(factored);
        Ok(())
    }

    /// Adds a block to what the estimate varies.
    fn add_score<const M: usize, const I: usize>(
        &mut self,
        layout: &Layout<M, N, I>,
        sums: &Products<N, R>,
        weight: f32,
        follows: bool,
    ) {
        let Some(factored) = &self.factored else {
            return;
        };
        let (mut matrix, mut score) = self.equations(layout, sums, &self.combined);
        for i in 0..N {
            for j in 0..N {
                score[i] -= matrix[i][j] * self.theta[j];
                matrix[i][j] *= weight;
            }
            score[i] *= weight;
        }
        self.spread.add(factored, &matrix, score, follows);
    }

    /// Adds what the rounding of the sums does to the estimate: `M^-1 e`, where the equation i errs
    /// by a share of its largest term. Behind trends that begin in motion that is the initial
    /// state, far above the noise.
    fn add_rounding<const M: usize, const I: usize>(
        &self,
        layout: &Layout<M, N, I>,
        covariance: &mut Matrix<N>,
    ) {
        let Some(factored) = &self.factored else {
            return;
        };
        let (matrix, _) = self.equations(layout, &self.total, &self.combined);
        for (i, line) in matrix.iter().enumerate() {
            let terms = line
                .iter()
                .zip(&self.theta)
                .map(|(entry, theta)| entry * theta);
            let largest = terms.fold(0.0, |largest, term| larger(largest, term.abs()));
            let unit = core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 });
            if !self.fixed[i] {
                let error = ROUNDING * largest;
                add_square(covariance, &factored.solve(&unit), error * error);
            }
        }
    }

    fn finish<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize>(
        &mut self,
        instruments: &Instruments<M, N, I, R>,
        identifier: &Identifier<T, M, N, I, D>,
    ) -> Found<M, N, I> {
        let blocks = instruments.blocks.effective();
        let parameters = self.fixed.iter().filter(|fixed| !**fixed).count() as f32;
        if !(blocks >= parameters + 2.0) {
            return self.recursion(identifier, Way::TooFewBlocks);
        }
        let layout = &instruments.layout;
        if is_weak::<M, N>(&layout.parameters, &self.theta, self.spread.scores()) {
            return self.recursion(identifier, Way::WeakInstruments);
        }
        let mut found = self.spread.found(blocks, parameters, &self.fixed);
        self.add_rounding(layout, &mut found.covariance);
        let without_constant = layout.constant().and_then(|index| {
            let unit = core::array::from_fn(|i| if i == index { 1.0 } else { 0.0 });
            Some(self.factored.as_ref()?.solve(&unit))
        });
        self.step = 0;
        Found {
            estimate: (identifier.read_out()).with_covariance(
                &self.theta,
                &found.covariance,
                without_constant,
                self.constant_variance,
            ),
            way: Way::Instruments,
            effective_blocks: found.effective,
        }
    }
}
