//! Trends: what takes the place of time derivatives (equations 1-8).
//!
//! Model (5) of order m, with `q^-1` the back shift and Delta the sample time:
//!
//! ```text
//! R_m y = - sum_i a_i R_i y + sum_i b_i P_i u          i = 0..m-1
//! ```
//!
//! | operator | symbol | what it gives |
//! |---|---|---|
//! | [`RawTrends`](crate::RawTrends) | `R_i`, `P_i` of (4) and (8) | the paper's trends, for data without noise |
//! | [`FilteredTrends`](crate::FilteredTrends) | `R_i / R_A`, `P_i / R_A` | the same through one stable filter: the default |
//! | [`ExactTrends`](crate::ExactTrends) | numerators of the hold in place of `P_i` | the same without an error of the sampling, for slow sampling |
//! | [`IntegralTrends`](crate::IntegralTrends) | `R_i ((1-q^-L)/(1-q^-1))^m` | the same over a span of L samples |
//!
//! All operators give trends in the unit of the signal times s^(i-m) (filtered)
//! or s^-i (raw), so that theta is the transfer function's in SI units.

pub(crate) mod bilinear;
pub(crate) mod delay_line;
pub(crate) mod exact;
pub(crate) mod filter;
pub(crate) mod filtered;
pub(crate) mod hold;
pub(crate) mod integral;
pub(crate) mod raw;

/// How the derivative becomes a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Scheme {
    /// Goodwin's delta operator `(q-1)/Delta`, equation (4).
    Goodwin,
    /// The modified Tustin transformation, equation (8).
    #[default]
    Tustin,
}

/// What an input does between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Hold {
    /// Held from u(k) until u(k+1): a command given by this controller.
    #[default]
    Zero,
    /// Runs straight from u(k) to u(k+1): a measured quantity.
    First,
}

/// The trends of one signal: orders 0..m-1 and the highest order m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trends<const M: usize> {
    /// Orders 0 to m-1.
    pub lower: [f32; M],
    /// Order m, the left-hand side of (5).
    pub top: f32,
}

/// Covariances of the filtered trends of white noise of variance 1 on y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseGain<const M: usize> {
    /// Between the trends of order i and j below m.
    pub lower: [[f32; M]; M],
    /// Between the trend of order i and the highest.
    pub mixed: [f32; M],
    /// Of the highest.
    pub top: f32,
}

impl<const M: usize> NoiseGain<M> {
    /// No noise passes.
    pub const ZERO: Self = Self {
        lower: [[0.0; M]; M],
        mixed: [0.0; M],
        top: 0.0,
    };

    /// Adds the outer product of one vector of trends, `weight` times.
    pub(crate) fn add(&mut self, g: &Trends<M>, weight: f32) {
        for i in 0..M {
            for j in 0..M {
                self.lower[i][j] += weight * g.lower[i] * g.lower[j];
            }
            self.mixed[i] += weight * g.lower[i] * g.top;
        }
        self.top += weight * g.top * g.top;
    }
}

/// A model seen in another plane: in s, or in the gamma of the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image<const M: usize> {
    /// a_0 .. a_{m-1} there.
    pub a: [f32; M],
    /// Every b_i there, and the constant, is this many times the one here.
    pub numerator: f32,
}

/// The step from samples to trends; one implementation per kind of trend.
///
/// The operator holds coefficients only; the memory of each signal lives with
/// its owner. Both schemes and all kinds give trends for the same model (5), so
/// the estimator behind does not know which one it is fed by.
pub trait TrendOperator<const M: usize>: Copy {
    /// What has to be remembered of one signal.
    type Memory: Copy + core::fmt::Debug + PartialEq;
    /// Memory of a signal that has been zero for ever.
    const EMPTY: Self::Memory;

    /// Sample time Delta in s.
    fn sample_time(&self) -> f32;
    /// Memory of an output that has had this value for ever.
    fn settled(&self, value: f32) -> Self::Memory;
    /// Memory of an input that has had this value for ever.
    fn settled_input(&self, value: f32, hold: Hold) -> Self::Memory;
    /// Takes y(k), gives `R_i y` for i = 0..m.
    fn output(&self, memory: &mut Self::Memory, y: f32) -> Trends<M>;
    /// Takes y(k) and y(k-1), gives `R_i y` for i = 1..m of a model without a_0; trend 0 is 0.
    ///
    /// Only movements enter, so the place where the drive stands costs no digits.
    fn movement(&self, memory: &mut Self::Memory, y: f32, before: f32) -> Trends<M>;
    /// Takes u(k), gives `P_i u` for i = 0..m-1; under a zero-order hold these use past inputs only.
    fn input(&self, memory: &mut Self::Memory, u: f32, hold: Hold) -> [f32; M];
    /// Weight of the newest y(k) in each trend: the `r_0^i` of (10).
    fn lead(&self) -> Trends<M>;
    /// Size of the highest trend of a signal of size 1 at `bandwidth` rad/s.
    fn gain(&self, bandwidth: f32) -> f32;
    /// f_0 .. f_{m-1} of the filter `A_f`; `None` where there is none.
    fn filter_polynomial(&self) -> Option<[f32; M]> {
        None
    }
    /// What white noise on y makes of the trends; zero where there is no filter.
    fn noise_gain(&self) -> NoiseGain<M> {
        NoiseGain::ZERO
    }
    /// By what the slowest real mode of the filter decays in one sample; 0 where there is no filter.
    fn decay(&self) -> f32 {
        0.0
    }
    /// Share of the error of the sampling that these trends leave to a model with the denominator `found`, 0 to 1.
    fn inexact(&self, _found: &[f32; M]) -> f32 {
        1.0
    }
    /// The continuous-time model that coefficients found with these trends stand for; `None`: these very ones.
    fn continuous(&self, _found: &[f32; M], _integrators: usize) -> Option<Image<M>> {
        None
    }
    /// The way back from [`TrendOperator::continuous`].
    fn sampled(&self, _a: &[f32; M], _integrators: usize) -> Option<Image<M>> {
        None
    }
    /// Samples until the memory is full.
    fn warm_up(&self) -> u32;
}

/// Applies `(1+q^-1)/2` `times` times to the newest sample and the M before it.
#[inline(always)]
fn average<const M: usize>(mut newest: f32, mut past: [f32; M], times: usize) -> f32 {
    for t in 0..times {
        newest = 0.5 * (newest + past[0]);
        for j in 0..M.saturating_sub(t + 1) {
            past[j] = 0.5 * (past[j] + past[j + 1]);
        }
    }
    newest
}

/// Trends of (8) over `newest` and the `order` samples before it, divided by `(2 Delta)^order`.
///
/// `lower[i] = ((1-q^-1)/Delta)^i ((1+q^-1)/2)^(order-i)`, by nested differences:
/// neighbouring samples are subtracted first, which is exact in f32 where the
/// products with a kernel 1, -3, 3, -1 would round.
#[inline(always)]
pub(crate) fn tustin<const M: usize>(
    newest: f32,
    past: &[f32; M],
    order: usize,
    rate: f32,
) -> Trends<M> {
    let mut trends = Trends {
        lower: [0.0; M],
        top: 0.0,
    };
    let mut head = newest;
    let mut tail = *past;
    for i in 0..M {
        if i > order {
            break;
        }
        trends.lower[i] = average(head, tail, order - i);
        difference(&mut head, &mut tail, i, rate);
    }
    // With order = M the loop leaves the highest difference in `head`.
    trends.top = head;
    trends
}

/// Trends of (4) over the M past samples, divided by `Delta^M`.
///
/// `lower[i] = ((1-q^-1)/Delta)^i q^-(M-i)`.
#[inline(always)]
pub(crate) fn goodwin<const M: usize>(newest: f32, past: &[f32; M], rate: f32) -> Trends<M> {
    let mut trends = Trends {
        lower: [0.0; M],
        top: 0.0,
    };
    let mut head = newest;
    let mut tail = *past;
    for i in 0..M {
        trends.lower[i] = tail[M - 1 - i];
        difference(&mut head, &mut tail, i, rate);
    }
    trends.top = head;
    trends
}

/// One more `(1-q^-1)/Delta`, on a series that has been differenced `level` times.
#[inline(always)]
fn difference<const M: usize>(head: &mut f32, tail: &mut [f32; M], level: usize, rate: f32) {
    *head = (*head - tail[0]) * rate;
    for j in 0..M.saturating_sub(level + 1) {
        tail[j] = (tail[j] - tail[j + 1]) * rate;
    }
}
