//! Sums of products over blocks of time, as many as fit a ring.
//!
//! ```text
//! S_b = sum over the rows of block b of z [phi' psi]          b = 0 .. 15
//! ```
//!
//! When all blocks are in use neighbours are added, which leaves eight, and a new block gets twice
//! the rows: whatever the length of the record, there are 8 to 16 blocks of equal length. With a
//! memory the blocks are scaled by `lambda^rows` when one closes and grow no longer than an eighth
//! of the memory; the two oldest are then added. At most one pair of blocks is added with a row.
//! Where a change of the drive is found the ring begins anew.
//!
//! Rows are summed apart before they enter their block: f32 adds at most [`APART`] rows, then at
//! most as many of these sums, with a rounding of `2^-24 sqrt(rows)` rather than of `2^-24` times
//! as many.

use crate::instruments::products::Products;

/// Blocks in the ring.
pub(crate) const BLOCKS: usize = 16;

/// Rows of the first blocks at least.
const FIRST: u32 = 8;

/// Rows that are summed apart.
const APART: u32 = 128;

/// The sums of a block.
#[derive(Debug, Clone, PartialEq)]
struct Block<const N: usize, const R: usize> {
    sums: Products<N, R>,
    /// What they count now.
    weight: f32,
    /// Rows in them.
    rows: f32,
}

impl<const N: usize, const R: usize> Block<N, R> {
    const EMPTY: Self = Self {
        sums: Products::ZERO,
        weight: 1.0,
        rows: 0.0,
    };
}

/// Rows of the longest and of the first blocks, and what rows count behind a first one.
fn first(forgetting: f32) -> (u32, u32, f32) {
    // With a memory the last doubling ends at an eighth of it.
    let longest = match forgetting < 1.0 {
        true => ((0.125 / (1.0 - forgetting)) as u32).max(FIRST),
        false => FIRST << 26,
    };
    let length = longest >> (longest / FIRST).ilog2();
    let decay = (0..length).fold(1.0, |decay, _| decay * forgetting);
    (longest, length, decay)
}

/// The ring of blocks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blocks<const N: usize, const R: usize> {
    /// Rows that are not in a block yet.
    fresh: Products<N, R>,
    fresh_rows: u32,
    blocks: [Block<N, R>; BLOCKS],
    /// Blocks from the oldest to the newest; the last one in use takes the rows.
    order: [u8; BLOCKS],
    used: usize,
    /// Rows of a whole block, and of the present one so far.
    length: u32,
    taken: u32,
    /// Rows of the longest block, for a memory.
    longest: u32,
    /// lambda^length.
    decay: f32,
    /// The next pair of neighbours to be added; all are where it is half of the blocks.
    pair: usize,
    /// Rows for which the blocks are left as they are, because somebody reads them.
    held: u32,
    /// Changes of the blocks so far.
    pub(crate) changes: u32,
}

impl<const N: usize, const R: usize> Blocks<N, R> {
    /// No rows; `forgetting` is lambda.
    pub(crate) fn new(forgetting: f32) -> Self {
        let mut order = [0; BLOCKS];
        for (i, slot) in order.iter_mut().enumerate() {
            *slot = i as u8;
        }
        let (longest, length, decay) = first(forgetting);
        Self {
            fresh: Products::ZERO,
            fresh_rows: 0,
            blocks: [const { Block::EMPTY }; BLOCKS],
            order,
            used: 1,
            length,
            taken: 0,
            longest,
            decay,
            pair: BLOCKS / 2,
            held: 0,
            changes: 0,
        }
    }

    /// Begins anew, with what [`new`](Self::new) was given; whoever reads the blocks sees it in
    /// their changes.
    ///
    /// A block without rows is none: only the one that takes the next rows has to be empty.
    pub(crate) fn begin(&mut self, forgetting: f32) {
        for block in &mut self.blocks {
            block.rows = 0.0;
        }
        self.used = 1;
        let newest = self.slot(0);
        if let Some(block) = self.blocks.get_mut(newest) {
            *block = Block::EMPTY;
        }
        self.fresh = Products::ZERO;
        (self.fresh_rows, self.taken, self.held) = (0, 0, 0);
        (self.longest, self.length, self.decay) = first(forgetting);
        self.pair = BLOCKS / 2;
        self.changes = self.changes.wrapping_add(1);
    }

    /// Takes the products of so many `rows` with the same instruments; `phi` and `psi` are their
    /// sums.
    #[inline(always)]
    pub(crate) fn update(&mut self, z: &[f32; R], phi: &[f32; N], psi: f32, rows: u32) {
        self.fresh.add_row(z, phi, psi);
        self.fresh_rows = self.fresh_rows.saturating_add(rows);
        if self.fresh_rows >= APART.min(self.length) || self.pair < BLOCKS / 2 {
            self.tidy(rows);
        }
    }

    /// The last parameter of the rows up to now is `value`, and that of the rows to come another
    /// one. Whoever reads the blocks sees it in their changes.
    pub(crate) fn settle_last(&mut self, value: f32) {
        self.fresh.settle_last(value);
        for block in &mut self.blocks {
            block.sums.settle_last(value);
        }
        self.changes = self.changes.wrapping_add(1);
    }

    /// Leaves the blocks as they are for so many rows.
    pub(crate) fn hold(&mut self, rows: u32) {
        self.held = rows;
    }

    /// Adds a pair of neighbours, or lets the rows summed apart into their block.
    #[inline(never)]
    fn tidy(&mut self, rows: u32) {
        if self.held > 0 {
            self.held = self.held.saturating_sub(rows);
            return;
        }
        self.changes = self.changes.wrapping_add(1);
        if self.pair < BLOCKS / 2 {
            self.add_pair();
            return;
        }
        let newest = self.slot(self.used - 1);
        if let Some(block) = self.blocks.get_mut(newest) {
            block.sums.add(1.0, &self.fresh, 1.0);
            block.rows += self.fresh_rows as f32;
        }
        self.taken = self.taken.saturating_add(self.fresh_rows);
        self.fresh = Products::ZERO;
        self.fresh_rows = 0;
        if self.taken >= self.length {
            self.close();
        }
    }

    fn slot(&self, place: usize) -> usize {
        usize::from(self.order.get(place).copied().unwrap_or(0))
    }

    /// Ends the newest block and begins another.
    fn close(&mut self) {
        self.taken = 0;
        for block in &mut self.blocks {
            block.weight *= self.decay;
        }
        if self.used < BLOCKS {
            self.used += 1;
        } else if self.length <= self.longest / 2 {
            self.length *= 2;
            self.decay *= self.decay;
            // Firsts of the pairs, then the seconds that become free.
            let before = self.order;
            let (firsts, seconds) = self.order.split_at_mut(BLOCKS / 2);
            for (places, pair) in firsts.iter_mut().zip(seconds).zip(before.chunks_exact(2)) {
                if let [first, second] = pair {
                    (*places.0, *places.1) = (*first, *second);
                }
            }
            self.used = BLOCKS / 2 + 1;
            self.pair = 0;
            self.add_pair();
        } else {
            self.add_to(0, 1);
            if let Some(rest) = self.order.get_mut(1..) {
                rest.rotate_left(1);
            }
        }
        let newest = self.slot(self.used - 1);
        if let Some(block) = self.blocks.get_mut(newest) {
            *block = Block::EMPTY;
        }
    }

    /// Adds the next pair of neighbours.
    fn add_pair(&mut self) {
        self.add_to(self.pair, BLOCKS / 2 + self.pair);
        self.pair += 1;
    }

    /// Adds the block at one place to that at another and empties it.
    fn add_to(&mut self, place: usize, other: usize) {
        let (place, other) = (self.slot(place), self.slot(other));
        let Some(taken) = self.blocks.get_mut(other) else {
            return;
        };
        let added = core::mem::replace(taken, Block::EMPTY);
        if let Some(block) = self.blocks.get_mut(place) {
            block.sums.add(block.weight, &added.sums, added.weight);
            block.rows = block.weight * block.rows + added.weight * added.rows;
            block.weight = 1.0;
        }
    }

    /// The block at a place from the oldest on, its weight, and whether it follows the one before
    /// without a gap; `None` where it is empty. The rows that are summed apart belong to none.
    pub(crate) fn block(&self, place: usize) -> Option<(&Products<N, R>, f32, bool)> {
        let block = self.blocks.get(self.slot(place));
        let block = block.filter(|block| block.rows > 0.0)?;
        // Where pairs are left to be added, the seconds of them stand behind all others.
        let follows =
            place > 0 && (self.pair >= BLOCKS / 2 || (place < BLOCKS / 2 && place <= self.pair));
        Some((&block.sums, block.weight, follows))
    }

    /// Rows that no block has yet.
    pub(crate) fn fresh(&self) -> &Products<N, R> {
        &self.fresh
    }

    /// How many blocks of equal size would spread their rows as these.
    pub(crate) fn effective(&self) -> f32 {
        let (mut sum, mut squares) = (0.0, 0.0);
        for block in &self.blocks {
            let rows = block.weight * block.rows;
            sum += rows;
            squares += rows * rows;
        }
        if squares > 0.0 {
            sum * (sum / squares)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests;
