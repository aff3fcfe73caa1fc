//! One of several kinds of trends, chosen at run time.

use crate::trends::chain::Chain;
use crate::trends::design::Design;
use crate::trends::difference::Trends;
use crate::trends::exact::ExactTrends;
use crate::trends::filtered::FilteredTrends;
use crate::trends::operator::{Form, Hold, Memory, TrendOperator, sealed};
use crate::trends::raw::{RawTrends, Window};

/// Raw, filtered or exact trends behind one type, for a host that chooses at run time.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyTrends<const M: usize> {
    /// Without a filter.
    Raw(RawTrends<M>),
    /// Through a filter.
    Filtered(FilteredTrends<M>),
    /// Through a filter, with the numerators of the hold.
    Exact(ExactTrends<M>),
}

/// The memory of [`AnyTrends`]: that of every kind.
#[derive(Debug, Clone, PartialEq)]
pub struct AnyMemory<const M: usize> {
    window: Window<M>,
    chain: Chain<M>,
}

impl<const M: usize> sealed::Sealed for AnyMemory<M> {}

impl<const M: usize> Memory<M> for AnyMemory<M> {
    fn output_at_rest(design: &Design<M>, form: Form, value: f32) -> Self {
        Self {
            window: Memory::output_at_rest(design, form, value),
            chain: Memory::output_at_rest(design, form, value),
        }
    }

    fn input_at_rest(design: &Design<M>, hold: Hold, value: f32) -> Self {
        Self {
            window: Memory::input_at_rest(design, hold, value),
            chain: Memory::input_at_rest(design, hold, value),
        }
    }

    fn flush(&mut self) {
        self.chain.flush();
    }

    fn add(&mut self, unit: &Self, weight: f32) {
        self.chain.add(&unit.chain, weight);
    }
}

impl<const M: usize> sealed::Sealed for AnyTrends<M> {}

impl<const M: usize> TrendOperator<M> for AnyTrends<M> {
    type Memory = AnyMemory<M>;

    fn output(&self, memory: &mut AnyMemory<M>, y: f32, form: Form) -> Trends<M> {
        match self {
            Self::Raw(trends) => trends.output(&mut memory.window, y, form),
            Self::Filtered(trends) => trends.output(&mut memory.chain, y, form),
            Self::Exact(trends) => trends.output(&mut memory.chain, y, form),
        }
    }

    fn input(&self, memory: &mut AnyMemory<M>, u: f32, hold: Hold) -> [f32; M] {
        match self {
            Self::Raw(trends) => trends.input(&mut memory.window, u, hold),
            Self::Filtered(trends) => trends.input(&mut memory.chain, u, hold),
            Self::Exact(trends) => trends.input(&mut memory.chain, u, hold),
        }
    }

    fn withdraw(&self, memory: &mut AnyMemory<M>, u: f32) {
        match self {
            Self::Raw(trends) => trends.withdraw(&mut memory.window, u),
            Self::Filtered(trends) => trends.withdraw(&mut memory.chain, u),
            Self::Exact(trends) => trends.withdraw(&mut memory.chain, u),
        }
    }

    fn design(&self) -> &Design<M> {
        match self {
            Self::Raw(trends) => trends.design(),
            Self::Filtered(trends) => trends.design(),
            Self::Exact(trends) => trends.design(),
        }
    }
}
