//! The instruments of an identifier with their sums, beside its recursion.
//!
//! One set of instruments serves a group of rows:
//!
//! ```text
//! G += z_g (sum over the rows of the group of [phi' psi])          z_g: the instruments at the begin of the group
//! ```
//!
//! An instrument may be any function of the inputs, hence also one that stands still for a while:
//! the estimate stays without bias, every row counts, and the filter and the products are computed
//! once for all of them. What it costs is correlation: over a group of `0.08/bandwidth` the exact
//! instruments turn by at most 0.08 rad, so that the standard deviation grows by about `0.08^2/6`,
//! one in a thousand. At 20 rad/s and 1 kHz a group has four rows.

use crate::estimation::rls::Estimator;
use crate::identifier::witness::Witness;
use crate::instruments::auxiliary::{Auxiliary, Lane};
use crate::instruments::blocks::Blocks;
use crate::instruments::layout::Layout;

/// Length of a group in units of 1/bandwidth.
const TURNS: f32 = 0.08;

/// Rows of a group at most: as many as the shortest block has.
const LARGEST: u32 = 8;

/// Rows of a group for bandwidth times sample time.
pub(super) fn group_of(angle: f32) -> u32 {
    let rows = (TURNS / angle + 0.5) as u32;
    rows.clamp(1, LARGEST)
}

/// The instruments: what they follow from, and what a sample changes.
///
/// What a sample touches stands in front of the blocks, in the order of the fields: a Cortex-M
/// reaches floating-point numbers up to 1 KiB behind a pointer without computing their address.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub(crate) struct Instruments<const M: usize, const N: usize, const I: usize, const R: usize> {
    pub(super) group: Group<N>,
    /// The instruments of the group.
    pub(super) z: [f32; R],
    /// lambda.
    pub(super) forgetting: f32,
    /// Groups until the filters are flushed.
    pub(super) turn: u32,
    pub(super) layout: Layout<M, N, I>,
    pub(super) auxiliary: Auxiliary<M>,
    pub(super) lanes: [Lane<M>; I],
    pub(super) blocks: Blocks<N, R>,
}

/// The rows since the instruments were renewed, added up.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Group<const N: usize> {
    phi: [f32; N],
    psi: f32,
    /// How many they are.
    rows: u32,
    /// Samples left, and samples of a group.
    left: u32,
    samples: u32,
}

impl<const N: usize> Group<N> {
    /// No rows: the next sample begins a group of so many `samples`.
    pub(super) const fn new(samples: u32) -> Self {
        Self {
            phi: [0.0; N],
            psi: 0.0,
            rows: 0,
            left: 0,
            samples,
        }
    }

    /// As constructed.
    pub(super) const fn reset(&mut self) {
        *self = Self::new(self.samples);
    }
}

impl<const M: usize, const N: usize, const I: usize, const R: usize> Witness<M, N, I>
    for Instruments<M, N, I, R>
{
    #[inline(never)]
    fn begin(&mut self) {
        self.group.left = 0;
        for lane in &mut self.lanes {
            lane.begin();
        }
    }

    #[inline(always)]
    fn inputs(&mut self, trends: &[[f32; M]; I], _: &[f32; I]) {
        match self.group.left.checked_sub(1) {
            Some(left) => self.group.left = left,
            None => self.next_group(trends),
        }
    }

    #[inline(always)]
    fn row(&mut self, phi: &[f32; N], psi: f32, _: &Estimator<N>, _: bool) {
        let group = &mut self.group;
        if group.rows == 0 {
            // Instruments and row end alike. A loop of known length.
            for k in 0..N.min(R) {
                if k + self.layout.outputs < N {
                    self.z[R - 1 - k] = phi[N - 1 - k];
                }
            }
            (group.phi, group.psi, group.rows) = (*phi, psi, 1);
            return;
        }
        for (sum, phi) in group.phi.iter_mut().zip(phi) {
            *sum += phi;
        }
        group.psi += psi;
        group.rows += 1;
    }

    #[inline(never)]
    fn another_initial_state(&mut self, before: f32) {
        let group = &mut self.group;
        if let Some(phi) = group.phi.last_mut() {
            group.psi -= before * *phi;
            *phi = 0.0;
        }
        if let Some(z) = self.z.last_mut() {
            *z = 0.0;
        }
        self.blocks.settle_last(before);
    }

    #[inline(never)]
    fn changed(&mut self) {
        self.begin_sums();
    }
}

impl<const M: usize, const N: usize, const I: usize, const R: usize> Instruments<M, N, I, R> {
    /// Rows up to now count no more; the filters go on.
    pub(super) fn begin_sums(&mut self) {
        self.group.rows = 0;
        self.blocks.begin(self.forgetting);
    }

    /// The products of the group enter the sums, and the instruments of the next one are those of
    /// these trends.
    #[inline(never)]
    fn next_group(&mut self, trends: &[[f32; M]; I]) {
        let group = &mut self.group;
        if group.rows > 0 {
            (self.blocks).update(&self.z, &group.phi, group.psi, group.rows);
        }
        group.rows = 0;
        group.left = group.samples - 1;
        self.turn = self.turn.wrapping_add(1);
        if self.turn.is_multiple_of(16) {
            for lane in &mut self.lanes {
                lane.flush();
            }
        }
        let mut rows = self.z.as_mut_slice();
        for c in 0..I {
            let Some((own, others)) = rows.split_at_mut_checked(self.layout.counts[c]) else {
                return;
            };
            self.lanes[c].update(&self.auxiliary, &trends[c], own);
            rows = others;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_lasts_for_a_share_of_the_time_constant() {
        for (angle, rows) in [(0.5, 1), (0.05, 2), (0.02, 4), (0.005, 8), (1e-6, 8)] {
            assert_eq!(group_of(angle), rows, "{angle}");
        }
    }
}
