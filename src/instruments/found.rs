//! What a reading gives.

use crate::readout::estimate::Estimate;

/// What an estimate rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Way {
    /// Instruments, with standard deviations from the blocks.
    Instruments,
    /// The recursion: there are too few blocks of samples yet.
    TooFewBlocks,
    /// The recursion: the instruments are weak, they hardly move with what y does.
    WeakInstruments,
}

/// An estimate with what it rests on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Found<const M: usize, const N: usize, const I: usize> {
    /// The model.
    pub estimate: Estimate<M, N, I>,
    /// What it rests on.
    pub way: Way,
    /// How many blocks carry the standard deviations: 16 at most, fewer where most of the motion is
    /// in some of them.
    pub effective_blocks: f32,
}
