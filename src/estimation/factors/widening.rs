//! Less known than before: squares of vectors added to P.
//!
//! Known as: rank-one update of Agee and Turner. Bierman, Factorization Methods for Discrete
//! Sequential Estimation (1977), ch. III.

use crate::estimation::factors::Factors;
use crate::math::{larger, smaller};

impl<const N: usize> Factors<N> {
    /// Makes the last parameter uncertain again: adds `variance` to P_nn and leaves all other
    /// entries of P.
    ///
    /// The part of P that the last column of U carried moves into the factors before it. Cost:
    /// about one row.
    pub(crate) fn inflate_last(&mut self, variance: f32) {
        let Some(last) = N.checked_sub(1) else {
            return;
        };
        let before = self.diagonal[last];
        let after = before + variance;
        if !(after > 0.0) {
            return;
        }
        let mut vector = self.upper[last];
        let weight = before * (variance / after);
        for entry in self.upper[last].iter_mut().take(last) {
            *entry *= before / after;
        }
        self.diagonal[last] = after;
        let (above, _) = vector.split_at_mut(last);
        self.add_square_of(above, weight);
    }

    /// P + v v' for each vector; a known parameter stays known. No D_j grows beyond the one in
    /// `limit`, or beyond itself where it is larger already; a vector that is not finite is left
    /// out. Cost: about one row for a vector.
    pub(crate) fn widen(&mut self, vectors: impl Iterator<Item = [f32; N]>, limit: &[f32; N]) {
        let before = self.diagonal;
        for mut vector in vectors.filter(|v| v.iter().all(|entry| entry.is_finite())) {
            for (entry, d) in vector.iter_mut().zip(before) {
                *entry = if d > 0.0 { *entry } else { 0.0 };
            }
            self.add_square_of(&mut vector, 1.0);
        }
        for ((d, before), limit) in self.diagonal.iter_mut().zip(before).zip(limit) {
            *d = smaller(*d, larger(before, *limit));
        }
    }

    /// Adds `weight` times the square of a vector of the first parameters to P, by the rank-one
    /// update of Agee and Turner.
    fn add_square_of(&mut self, mut rest: &mut [f32], mut weight: f32) {
        // From the last one down, without an index that would have to be checked.
        let columns = self.diagonal.iter_mut().zip(&mut self.upper);
        for (diagonal, column) in columns.take(rest.len()).rev() {
            let Some((v, below)) = core::mem::take(&mut rest).split_last_mut() else {
                break;
            };
            let (v, old) = (*v, *diagonal);
            let new = old + weight * v * v;
            if new > 0.0 {
                let share = weight * v / new;
                for (entry, x) in column.iter_mut().zip(below.iter_mut()) {
                    *x -= v * *entry;
                    *entry += share * *x;
                }
                weight *= old / new;
                *diagonal = new;
            }
            rest = below;
        }
    }
}
