//! Raw, filtered or exact trends as one operator.

use trendid::{
    ExactTrends, FilteredTrends, Hold, Image, NoiseGain, RawTrends, TrendOperator, Trends,
};

/// Raw, filtered or exact trends behind one type, so that each size is compiled once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum AnyTrends<const M: usize> {
    Raw(RawTrends<M>),
    Filtered(FilteredTrends<M>),
    Exact(ExactTrends<M>),
}

/// Calls the same method on whichever operator it is.
macro_rules! either {
    ($self:ident, $trends:ident => $call:expr) => {
        match $self {
            Self::Raw($trends) => $call,
            Self::Filtered($trends) => $call,
            Self::Exact($trends) => $call,
        }
    };
}

impl<const M: usize> TrendOperator<M> for AnyTrends<M> {
    type Memory = [f32; M];
    const EMPTY: [f32; M] = [0.0; M];

    fn sample_time(&self) -> f32 {
        either!(self, t => t.sample_time())
    }
    fn settled(&self, value: f32) -> [f32; M] {
        either!(self, t => t.settled(value))
    }
    fn settled_input(&self, value: f32, hold: Hold) -> [f32; M] {
        either!(self, t => t.settled_input(value, hold))
    }
    fn output(&self, memory: &mut [f32; M], y: f32) -> Trends<M> {
        either!(self, t => t.output(memory, y))
    }
    fn movement(&self, memory: &mut [f32; M], y: f32, before: f32) -> Trends<M> {
        either!(self, t => t.movement(memory, y, before))
    }
    fn input(&self, memory: &mut [f32; M], u: f32, hold: Hold) -> [f32; M] {
        either!(self, t => t.input(memory, u, hold))
    }
    fn lead(&self) -> Trends<M> {
        either!(self, t => t.lead())
    }
    fn gain(&self, bandwidth: f32) -> f32 {
        either!(self, t => t.gain(bandwidth))
    }
    fn filter_polynomial(&self) -> Option<[f32; M]> {
        either!(self, t => t.filter_polynomial())
    }
    fn noise_gain(&self) -> NoiseGain<M> {
        either!(self, t => t.noise_gain())
    }
    fn decay(&self) -> f32 {
        either!(self, t => t.decay())
    }
    fn inexact(&self, found: &[f32; M]) -> f32 {
        either!(self, t => t.inexact(found))
    }
    fn continuous(&self, found: &[f32; M], integrators: usize) -> Option<Image<M>> {
        either!(self, t => t.continuous(found, integrators))
    }
    fn sampled(&self, a: &[f32; M], integrators: usize) -> Option<Image<M>> {
        either!(self, t => t.sampled(a, integrators))
    }
    fn warm_up(&self) -> u32 {
        either!(self, t => t.warm_up())
    }
}
