//! The step from samples to trends, as the identifier sees it.

use core::fmt::Debug;

use crate::trends::design::Design;
use crate::trends::difference::Trends;

/// Course of an input between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Hold {
    /// Held from u(k) until u(k+1): a command given by this controller.
    #[default]
    Zero,
    /// Linear between u(k) and u(k+1): a measured quantity.
    First,
    /// u(k) is the mean since sample k-1: what is known only when it is over, such as the friction
    /// of a drive that has turned in between. Raw trends by Goodwin's scheme and trends over a span
    /// take it as `First`.
    Mean,
}

/// How an output enters its trends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Form {
    /// By its value: every trend, for a model with a_0.
    #[default]
    Position,
    /// By its increments, for a model without a_0: the position at which the drive stands costs no
    /// digits. Trend 0 has no meaning then.
    #[doc(alias = "movement")]
    Increment,
}

/// Seals the traits of this module: a new kind of trend is a change of this crate.
pub(crate) mod sealed {
    pub trait Sealed {}
}

/// Memory of the trends of one signal.
pub trait Memory<const M: usize>: Clone + Debug + PartialEq + sealed::Sealed {
    /// Memory of an output that has always had this value.
    #[doc(alias = "settled")]
    fn output_at_rest(design: &Design<M>, form: Form, value: f32) -> Self;
    /// Memory of an input that has always had this value.
    #[doc(alias = "settled_input")]
    fn input_at_rest(design: &Design<M>, hold: Hold, value: f32) -> Self;
    /// Sets what has decayed beyond any use to zero, before it becomes subnormal; nothing decays in
    /// windows of samples.
    fn flush(&mut self) {}
    /// Adds `weight` times the trends that `unit` leads to; windows of samples have none soon.
    fn add(&mut self, _unit: &Self, _weight: f32) {}
}

/// The step from samples to trends; one implementation per kind of trend.
///
/// The operator holds coefficients only; the memory of each signal lives with
/// its owner. Both schemes and all kinds give trends for the same model (5), so
/// the estimator does not depend on the kind.
pub trait TrendOperator<const M: usize>: Clone + Debug + PartialEq + sealed::Sealed {
    /// Memory of one signal.
    type Memory: Memory<M>;

    /// Takes y(k), gives `R_i y` for i = 0..m.
    fn output(&self, memory: &mut Self::Memory, y: f32, form: Form) -> Trends<M>;
    /// Takes u(k), gives `P_i u` for i = 0..m-1; under a zero-order hold these use past inputs
    /// only.
    fn input(&self, memory: &mut Self::Memory, u: f32, hold: Hold) -> [f32; M];
    /// As if an input that is held at `u` from the newest sample on were 0 from there on. Trends
    /// over a span go on with it.
    fn withdraw(&self, _memory: &mut Self::Memory, _u: f32) {}
    /// Everything that follows from the coefficients, computed once.
    fn design(&self) -> &Design<M>;
}
