//! The recursion at the ends of blocks of time, as many as fit a ring.
//!
//! What a block of rows adds to the equations of least squares follows from the recursion before
//! and behind it: with the information `I = P^-1` and any parameters t
//!
//! ```text
//! d = I (theta - t) = sum of all rows so far of phi (psi - phi' t), and what the prior adds
//! s_b = d_b - lambda^rows d_(b-1)          sum over the rows of block b of phi (psi - phi' t)
//! ```
//!
//! so that a sample costs a comparison, and a block a copy of U, D and theta. `theta - t` is small:
//! nothing cancels.
//!
//! When the ring is full every other snapshot goes, which leaves eight, and a new block gets twice
//! the rows: whatever the length of the record, there are 8 to 16 blocks of equal length. With a
//! memory blocks grow no longer than an eighth of it; the oldest snapshot then goes, and what was
//! before it and behind it is one block. What no row explains (the drive has changed, the initial
//! state is unknown again) begins the ring anew: everything learnt before is then one block.

use crate::estimation::rls::Estimator;
use crate::identifier::witness::Witness;
use crate::math::matrix::Matrix;
use crate::math::power;

/// Snapshots in the ring.
pub(crate) const SNAPSHOTS: usize = 16;

/// Rows of the first blocks at least.
const FIRST: u32 = 8;

/// The recursion at one time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Snapshot<const N: usize> {
    theta: [f32; N],
    /// U above the diagonal and D on it, column by column.
    factors: Matrix<N>,
    /// Weight of the samples in it.
    pub(super) samples: f32,
    /// The same of those that were forgotten for: information, where as much comes as goes.
    pub(super) forgotten: f32,
    /// What it counts now.
    pub(super) weight: f32,
}

impl<const N: usize> Snapshot<N> {
    const EMPTY: Self = Self {
        theta: [0.0; N],
        factors: [[0.0; N]; N],
        samples: 0.0,
        forgotten: 0.0,
        weight: 0.0,
    };

    fn of(estimator: &Estimator<N>, forgotten: f32) -> Self {
        Self {
            theta: *estimator.theta(),
            factors: estimator.factors(),
            samples: estimator.samples(),
            forgotten,
            weight: 1.0,
        }
    }

    /// d = U^-T D^-1 U^-1 (theta - t); 0 for a known parameter.
    #[inline(never)]
    pub(super) fn score(&self, t: &[f32; N]) -> [f32; N] {
        let mut d: [f32; N] = core::array::from_fn(|j| self.theta[j] - t[j]);
        for j in (0..N).rev() {
            let x = d[j];
            for (value, entry) in d.iter_mut().zip(&self.factors[j]).take(j) {
                *value -= entry * x;
            }
        }
        for j in 0..N {
            let variance = self.factors[j][j];
            d[j] = if variance > 0.0 { d[j] / variance } else { 0.0 };
        }
        for j in 0..N {
            let before = d.iter().zip(&self.factors[j]).take(j);
            d[j] -= before.map(|(x, entry)| x * entry).sum::<f32>();
        }
        d
    }
}

/// The ring of snapshots.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Snapshots<const N: usize> {
    /// The recursion before the first block.
    pub(super) begin: Snapshot<N>,
    ring: [Snapshot<N>; SNAPSHOTS],
    /// Places of the snapshots in the ring from the oldest to the newest, and how many are in use.
    order: [u8; SNAPSHOTS],
    used: usize,
    /// lambda.
    forgetting: f32,
    /// Rows of a whole block that were forgotten for, and of the present one so far.
    length: u32,
    taken: u32,
    /// lambda^length.
    decay: f32,
    /// Weight of the samples that were forgotten for up to the newest snapshot.
    forgotten: f32,
    /// The same of the first blocks, so that the last doubling ends at the longest for a memory.
    shortest: u32,
    longest: u32,
    /// Begins anew with the next row.
    stale: bool,
}

impl<const N: usize> Snapshots<N> {
    /// No rows yet; `forgetting` is lambda.
    pub(super) fn new(estimator: &Estimator<N>, forgetting: f32) -> Self {
        let longest = match forgetting < 1.0 {
            true => ((0.125 / (1.0 - forgetting)) as u32).max(FIRST),
            false => FIRST << 26,
        };
        let shortest = longest >> (longest / FIRST).ilog2();
        Self {
            begin: Snapshot::of(estimator, 0.0),
            ring: [const { Snapshot::EMPTY }; SNAPSHOTS],
            order: core::array::from_fn(|place| place as u8),
            used: 0,
            forgetting,
            length: shortest,
            taken: 0,
            decay: power(forgetting, shortest),
            forgotten: 0.0,
            shortest,
            longest,
            stale: false,
        }
    }

    /// Ends the present block, or begins anew.
    #[inline(never)]
    fn close(&mut self, estimator: &Estimator<N>) {
        let decay = match self.stale {
            true => self.newest(),
            false => self.decay,
        };
        self.forgotten = self.forgotten(decay);
        self.taken = 0;
        if self.stale {
            self.stale = false;
            self.used = 0;
            self.length = self.shortest;
            self.decay = power(self.forgetting, self.shortest);
            self.begin = Snapshot::of(estimator, self.forgotten);
            return;
        }
        self.begin.weight *= self.decay;
        for snapshot in &mut self.ring {
            snapshot.weight *= self.decay;
        }
        let place = self.order.get(self.used).copied().unwrap_or(0);
        if let Some(slot) = self.ring.get_mut(usize::from(place)) {
            *slot = Snapshot::of(estimator, self.forgotten);
        }
        self.used += 1;
        if self.used == SNAPSHOTS {
            self.make_room();
        }
    }

    /// Every other snapshot goes, or the oldest.
    fn make_room(&mut self) {
        if self.length > self.longest / 2 {
            self.order.rotate_left(1);
            self.used -= 1;
            return;
        }
        self.length *= 2;
        self.decay *= self.decay;
        let before = self.order;
        let (kept, free) = self.order.split_at_mut(SNAPSHOTS / 2);
        for (places, pair) in kept.iter_mut().zip(free).zip(before.chunks_exact(2)) {
            if let [first, second] = pair {
                (*places.0, *places.1) = (*second, *first);
            }
        }
        self.used = SNAPSHOTS / 2;
    }

    /// Weight of the samples that were forgotten for up to now, the present block counting
    /// lambda^rows = `decay`.
    fn forgotten(&self, decay: f32) -> f32 {
        let fresh = match self.forgetting < 1.0 {
            true => (1.0 - decay) / (1.0 - self.forgetting),
            false => self.taken as f32,
        };
        decay * self.forgotten + fresh
    }

    /// The recursion now.
    pub(super) fn now(&self, estimator: &Estimator<N>) -> Snapshot<N> {
        Snapshot::of(estimator, self.forgotten(self.newest()))
    }

    /// What the newest snapshot counts now.
    const fn newest(&self) -> f32 {
        power(self.forgetting, self.taken)
    }

    /// The snapshots from the oldest to the newest, each with what it counts now.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&Snapshot<N>, f32)> {
        let newest = self.newest();
        self.order.iter().take(self.used).filter_map(move |place| {
            let snapshot = self.ring.get(usize::from(*place))?;
            Some((snapshot, snapshot.weight * newest))
        })
    }

    /// What the recursion before the first block counts now.
    pub(super) fn begin_weight(&self) -> f32 {
        self.begin.weight * self.newest()
    }
}

impl<const M: usize, const N: usize, const I: usize> Witness<M, N, I> for Snapshots<N> {
    #[inline(always)]
    fn begin(&mut self) {}

    #[inline(always)]
    fn inputs(&mut self, _: &[[f32; M]; I], _: &[f32; I]) {}

    #[inline(always)]
    fn row(&mut self, _: &[f32; N], _: f32, estimator: &Estimator<N>, forgot: bool) {
        self.taken += u32::from(forgot);
        if self.taken >= self.length || self.stale {
            self.close(estimator);
        }
    }

    #[inline(always)]
    fn widened(&mut self) {
        self.stale = true;
    }
}
