//! The instruments of an identifier with their sums, beside its recursion.

use crate::identifier::witness::Witness;
use crate::instruments::auxiliary::{Auxiliary, Lane};
use crate::instruments::blocks::Blocks;
use crate::instruments::layout::Layout;

/// The instruments: what they follow from, and what a sample changes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Instruments<const M: usize, const N: usize, const I: usize, const R: usize> {
    pub(super) layout: Layout<M, N, I>,
    pub(super) auxiliary: Auxiliary<M>,
    pub(super) lanes: [Lane<M>; I],
    /// The newest instruments.
    pub(super) z: [f32; R],
    pub(super) blocks: Blocks<N, R>,
    /// lambda.
    pub(super) forgetting: f32,
    /// Samples until the filters are flushed.
    pub(super) turn: u32,
}

impl<const M: usize, const N: usize, const I: usize, const R: usize> Witness<M, N, I>
    for Instruments<M, N, I, R>
{
    #[inline(never)]
    fn begin(&mut self) {
        for lane in &mut self.lanes {
            lane.begin();
        }
    }

    #[inline(always)]
    fn inputs(&mut self, trends: &[[f32; M]; I]) {
        self.turn = self.turn.wrapping_add(1);
        if self.turn.is_multiple_of(64) {
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

    #[inline(always)]
    fn row(&mut self, phi: &[f32; N], psi: f32) {
        let own = self.z.iter_mut().skip(self.layout.twice);
        for (z, phi) in own.zip(phi.iter().skip(self.layout.outputs)) {
            *z = *phi;
        }
        self.blocks.update(&self.z, phi, psi);
    }
}
