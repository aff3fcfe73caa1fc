//! A first model by linear regression on filtered signals, for several delays at once.

use crate::math::matrix::{backward, cholesky, forward};
use crate::math::sqrt;
use crate::servo::commissioning::predictor::{Point, Theta};
use crate::servo::commissioning::record::MotionRecord;
use crate::servo::commissioning::regression::filter::{Filter, Spacing};
use crate::servo::commissioning::view::View;
use crate::servo::control::load::loss_over_gain;

/// Parameters: a1, a2, friction, constant, which have the same regressors under every delay; then
/// b0, and b0 times the dead zone.
const SHARED: usize = 4;
const TERMS: usize = 6;
/// Delays of the valve in s that are compared, beside the one that was stated.
const DELAYS: [f32; 3] = [5e-3, 9e-3, 14e-3];
const COMPARED: usize = DELAYS.len() + 1;
/// Points of filtered commands that are kept for the delays.
const KEPT: usize = 32;
/// Times over 1/rate in which the filters settle, at first and after a start of the axis.
const SETTLED: f32 = 4.0;
const STARTED: f32 = 1.2;

/// Rows of the normal equations, up to their diagonals, of all delays or of one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rows<const ROWS: usize, const COLUMNS: usize> {
    matrix: [[f32; COLUMNS]; ROWS],
    right: [f32; ROWS],
}

type Shared = Rows<SHARED, SHARED>;
type Delayed = Rows<{ TERMS - SHARED }, TERMS>;

impl<const ROWS: usize, const COLUMNS: usize> Rows<ROWS, COLUMNS> {
    const NONE: Self = Self {
        matrix: [[0.0; COLUMNS]; ROWS],
        right: [0.0; ROWS],
    };

    /// Adds an equation; `row` ends with the regressors of these rows.
    #[inline]
    fn add(&mut self, row: &[f32; COLUMNS], target: f32) {
        let before = COLUMNS - ROWS;
        let own = row.iter().enumerate().skip(before);
        let rows = self.matrix.iter_mut().zip(&mut self.right);
        for ((sums, right), (j, a)) in rows.zip(own) {
            *right += a * target;
            for (sum, b) in sums.iter_mut().zip(row).take(j + 1) {
                *sum += a * b;
            }
        }
    }
}

/// The regression, a few points per sample.
///
/// ```text
/// y''' = - a1 y' - a2 y'' + b0 q(u(t - tau)) - b0 (dz - dz0) sgn(u(t - tau)) - F d/dt sgn(v) + constant
/// ```
///
/// All signals pass the same filter, so that no derivative is taken of the position. Filtered
/// commands are smooth: a delay is read between them. The delay with the smallest error wins.
///
/// Known as: state-variable filter, least squares (Young 1981).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Regression {
    view: View,
    rate: f32,
    spacing: Spacing,
    dead_zone: f32,
    position: Filter,
    active: Filter,
    sign: Filter,
    direction: Filter,
    kept: [[f32; 2]; KEPT],
    next: usize,
    moving: u32,
    origin: f32,
    squares: f32,
    delays: [f32; COMPARED],
    stiffening: f32,
    shared: Shared,
    delayed: [Delayed; COMPARED],
    /// Delays that are solved, and the model of the one with the smallest error.
    solved: usize,
    found: Option<(f32, Theta)>,
}

impl Regression {
    /// `stated` is the delay that the user knows or guesses; a `stiffening` that is not known is
    /// none at first.
    #[inline(always)]
    pub(crate) const fn new(stated: f32, stiffening: f32) -> Self {
        let [second, third, fourth] = DELAYS;
        Self {
            delays: [stated, second, third, fourth],
            stiffening,
            view: View::EMPTY,
            rate: 1.0,
            spacing: Spacing::NONE,
            dead_zone: 0.0,
            position: Filter::AT_REST,
            active: Filter::AT_REST,
            sign: Filter::AT_REST,
            direction: Filter::AT_REST,
            kept: [[0.0; 2]; KEPT],
            next: 0,
            moving: 0,
            origin: 0.0,
            squares: 0.0,
            shared: Shared::NONE,
            delayed: [Delayed::NONE; COMPARED],
            solved: 0,
            found: None,
        }
    }

    /// Begins with filters of this rate and a dead zone that is surely not larger than the true
    /// one.
    pub(crate) fn begin(&mut self, record: &MotionRecord, view: View, rate: f32, dead_zone: f32) {
        self.view = view;
        self.rate = rate.min(0.35 / view.time);
        self.spacing = Spacing::new(self.rate, view.time);
        self.dead_zone = dead_zone;
        for filter in [
            &mut self.position,
            &mut self.active,
            &mut self.sign,
            &mut self.direction,
        ] {
            *filter = Filter::AT_REST;
        }
        self.kept = [[0.0; 2]; KEPT];
        self.next = view.begin;
        self.moving = 0;
        self.origin = record.y(view.begin);
        self.squares = 0.0;
        self.shared = Shared::NONE;
        self.delayed = [Delayed::NONE; COMPARED];
        self.solved = 0;
        self.found = None;
    }

    /// Takes `points` more; whether there were none left. Cost: some 780 instructions per point.
    pub(crate) fn advance(&mut self, record: &MotionRecord, points: usize) -> bool {
        let time = self.view.time;
        let settled = self.view.begin + (SETTLED / (self.rate * time)) as usize;
        let started = (STARTED / (self.rate * time)) as u32;
        for taken in 0..points {
            let i = self.next;
            if i + self.view.beyond() >= self.view.end {
                return taken == 0;
            }
            let point = Point::of(record, i, &self.view);
            self.moving = if point.rests {
                0
            } else {
                self.moving.saturating_add(1)
            };
            self.kept[i % KEPT] = [self.active.state[0], self.sign.state[0]];
            if i >= settled && self.moving > started {
                self.add(i, point.y - self.origin);
            }
            let u = self.view.sign * record.u(i, 0);
            let d = self.dead_zone;
            let (active, sign) = if u > d {
                (u - d, 1.0)
            } else if u < -d {
                (u + d, -1.0)
            } else {
                (0.0, 0.0)
            };
            let y = 0.5 * (point.y + record.y(i + 1)) - self.origin;
            self.position.advance(y, &self.spacing);
            self.active.advance(active, &self.spacing);
            self.sign.advance(sign, &self.spacing);
            self.direction.advance(point.direction, &self.spacing);
            self.next += 1;
        }
        false
    }

    /// Adds the equation of point `i` to the sums of every delay.
    fn add(&mut self, i: usize, y: f32) {
        let rate = self.rate;
        let state = self.position.state;
        let cube = rate * rate * rate;
        // In units of the filter, so that all terms are of one size.
        let target = Filter::highest(state, y, rate) / cube;
        let (first, second) = (state[1] / rate, state[2] / (rate * rate));
        let friction = self.direction.state[1] / rate;
        self.squares += target * target;
        let shared = [-first, -second, -friction, 1.0];
        self.shared.add(&shared, target);
        for (delayed, delay) in self.delayed.iter_mut().zip(self.delays) {
            let back = delay / self.view.time;
            let whole = back as usize;
            let part = back - whole as f32;
            let newer = self.kept[(i + KEPT - whole) % KEPT];
            let older = self.kept[(i + KEPT - whole - 1) % KEPT];
            let read = |k: usize| newer[k] + part * (older[k] - newer[k]);
            let [a, b, c, d] = shared;
            delayed.add(&[a, b, c, d, read(0), -read(1)], target);
        }
    }

    /// Solves the equations of one delay more; whether that was the last one. Cost: some 1300
    /// instructions.
    pub(crate) fn solve_next(&mut self) -> bool {
        if let (Some(delayed), Some(delay)) =
            (self.delayed.get(self.solved), self.delays.get(self.solved))
            && let Some((error, theta)) = self.solve(delayed, *delay)
            && self.found.is_none_or(|(other, _)| error < other)
        {
            self.found = Some((error, theta));
        }
        self.solved += 1;
        self.solved >= COMPARED
    }

    /// The model of the delay with the smallest error; nothing when no delay gives a drive.
    pub(crate) fn best(&self) -> Option<Theta> {
        self.found.map(|(_, theta)| theta)
    }

    fn solve(&self, delayed: &Delayed, delay: f32) -> Option<(f32, Theta)> {
        let ([p, q, r, s], [t, u]) = (self.shared.matrix, delayed.matrix);
        let [p, q, r, s] = [p, q, r, s].map(|[a, b, c, d]| [a, b, c, d, 0.0, 0.0]);
        let mut matrix = [p, q, r, s, t, u];
        let ([p, q, r, s], [t, u]) = (self.shared.right, delayed.right);
        let right = [p, q, r, s, t, u];
        for (j, row) in matrix.iter_mut().enumerate() {
            row[j] *= 1.0 + 1e-4;
        }
        let factor = cholesky(&matrix)?;
        let found = backward(&factor, forward(&factor, right));
        let explained: f32 = found.iter().zip(&right).map(|(a, b)| a * b).sum();
        let rate = self.rate;
        let [a1, a2, friction, constant, b0, null] = found;
        let (a1, a2, b0) = (a1 * rate * rate, a2 * rate, b0 * rate * rate * rate);
        if !(a1 > 9.0 && a1 < 9e4 && b0 > 1e-3 * a1 && b0 < 50.0 * a1) {
            return None;
        }
        let w = sqrt(a1);
        let gain = b0 / (rate * rate * rate);
        let theta = Theta {
            a1,
            a2: a2.max(0.02 * w).min(8.0 * w),
            b0,
            dead_zone: (self.dead_zone + null / gain).clamp(0.0, 0.3),
            offset: (constant / gain).clamp(-0.3, 0.3),
            friction: (friction * rate * rate).max(0.0).min(b0 / w),
            delay,
            kappa: loss_over_gain(self.stiffening) * b0 / a1,
            imbalance: 0.0,
            stiffening: self.stiffening,
        };
        Some((self.squares - explained, theta))
    }
}

mod filter;
#[cfg(test)]
mod tests;
