//! Trends over a span: the linear integral filter, with which the paper compares its own method.

use crate::error::{ConfigError, assert_order, check_positive};
use crate::trends::design::{Design, Plane, Size};
use crate::trends::difference::{Scheme, Trends};
use crate::trends::noise_gain::NoiseGain;
use crate::trends::operator::{Form, Hold, Memory, TrendOperator, sealed};

/// Trends over a span of `L` samples (linear integral filter; S. Sagara, Z. Zhao: Numerical
/// integration approach to on-line identification of continuous-time systems. 1990), recursive.
///
/// Both sides of (5) are multiplied by `((1-q^-L)/(1-q^-1))^m`, which turns every
/// difference over one sample into one over L samples, and every mean into an
/// integral over L samples:
///
/// ```text
/// trend i of y = D^i S^(m-i) y         D = 1 - q^-L
/// S = Delta/2 (1+q^-1) (1-q^-L)/(1-q^-1)        (Tustin; Goodwin: Delta q^-1 (1-q^-L)/(1-q^-1))
/// trend i of u = D^i S^(m-1-i) S_u u,  S_u = Delta q^-1 (1-q^-L)/(1-q^-1) for a held input
/// ```
///
/// Samples older than m L are forgotten, and with them every initial error. The price is
/// memory: about `4 m^2 L` bytes per signal. Best span: about
/// 1.4/omega0 seconds. [`FilteredTrends`](crate::trends::FilteredTrends) is more accurate under
/// noise and needs m numbers.
///
/// # Examples
/// ```
/// use trendid::trends::{Form, IntegralTrends, Memory, Scheme, Span, TrendOperator};
/// let trends = IntegralTrends::<1, 4>::try_new(Scheme::Tustin, 0.5)?;
/// let mut memory = Span::output_at_rest(trends.design(), Form::Position, 0.0);
/// let mut last = trends.output(&mut memory, 0.0, Form::Position);
/// for k in 1..=8 {
///     last = trends.output(&mut memory, k as f32, Form::Position);
/// }
/// assert_eq!(last.top, 4.0); // 8 - 4: the difference over four samples
/// assert_eq!(last.lower, [12.0]); // the integral of the ramp from 4 to 8 over 2 s
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// An order outside 1..=4 does not compile:
/// ```compile_fail,E0080
/// use trendid::trends::{IntegralTrends, Scheme};
/// let trends = IntegralTrends::<5, 10>::try_new(Scheme::Tustin, 0.001);
/// ```
#[doc(alias = "linear integral filter")]
#[doc(alias = "LIF")]
#[derive(Debug, Clone, PartialEq)]
pub struct IntegralTrends<const M: usize, const L: usize> {
    design: Design<M>,
}

/// Memory of one signal of [`IntegralTrends`].
#[derive(Debug, Clone, PartialEq)]
pub struct Span<const M: usize, const L: usize> {
    /// Ring j holds the signal integrated j times, M spans long.
    rings: [[[f32; L]; M]; M],
    /// The running sums, and the sums that replace them once per span so that rounding does not
    /// pile up.
    sums: [f32; M],
    fresh: [f32; M],
    /// The value of each ring that the newest one has overwritten, M spans old.
    oldest: [f32; M],
    newest: usize,
    age: usize,
}

impl<const M: usize, const L: usize> Span<M, L> {
    const EMPTY: Self = Self {
        rings: [[[0.0; L]; M]; M],
        sums: [0.0; M],
        fresh: [0.0; M],
        oldest: [0.0; M],
        newest: 0,
        age: 0,
    };

    /// Value of ring `j`, `lag` samples before the newest.
    #[inline(always)]
    fn past(&self, j: usize, lag: usize) -> f32 {
        let length = M * L;
        if lag >= length {
            return self.oldest.get(j).copied().unwrap_or(0.0);
        }
        let index = if self.newest >= lag {
            self.newest - lag
        } else {
            (self.newest + length).saturating_sub(lag)
        };
        self.rings
            .get(j)
            .and_then(|ring| ring.as_flattened().get(index))
            .copied()
            .unwrap_or(0.0)
    }

    /// Moves every ring one sample on.
    #[inline(always)]
    fn advance(&mut self) {
        self.newest = if self.newest + 1 < M * L {
            self.newest + 1
        } else {
            0
        };
        self.age = if self.age + 1 < L { self.age + 1 } else { 0 };
    }

    /// Puts the newest value of ring `j`.
    #[inline(always)]
    fn put(&mut self, j: usize, value: f32) {
        let newest = self.newest;
        if let (Some(slot), Some(oldest)) = (
            self.rings
                .get_mut(j)
                .and_then(|ring| ring.as_flattened_mut().get_mut(newest)),
            self.oldest.get_mut(j),
        ) {
            *oldest = *slot;
            *slot = value;
        }
    }

    /// Sum of the last L values of ring j.
    #[inline(always)]
    fn slide(&mut self, j: usize, entering: f32, leaving: f32) -> f32 {
        let (Some(sum), Some(fresh)) = (self.sums.get_mut(j), self.fresh.get_mut(j)) else {
            return 0.0;
        };
        *sum += entering - leaving;
        *fresh += entering;
        if self.age == 0 {
            *sum = *fresh;
            *fresh = 0.0;
        }
        *sum
    }

    /// The memory after as many equal samples as it holds.
    fn settled(value: f32, step: impl Fn(&mut Self)) -> Self {
        let mut memory = Self::EMPTY;
        if value == 0.0 {
            return memory; // behind an integrator, where the first sample is the origin
        }
        for _ in 0..(M + 1) * L {
            step(&mut memory);
        }
        memory
    }

    /// D^i of ring j: the alternating binomial sum over spans.
    #[inline(always)]
    fn difference(&self, j: usize, i: usize, newest: f32) -> f32 {
        let mut sum = newest;
        let mut weight = 1.0;
        for k in 1..=i {
            weight *= -((i + 1 - k) as f32) / k as f32;
            sum += weight * self.past(j, k * L);
        }
        sum
    }
}

impl<const M: usize, const L: usize> sealed::Sealed for Span<M, L> {}

impl<const M: usize, const L: usize> Memory<M> for Span<M, L> {
    fn output_at_rest(design: &Design<M>, form: Form, value: f32) -> Self {
        let design = design.clone();
        let trends = IntegralTrends::<M, L> { design };
        Self::settled(value, |memory| {
            trends.output(memory, value, form);
        })
    }

    fn input_at_rest(design: &Design<M>, hold: Hold, value: f32) -> Self {
        let design = design.clone();
        let trends = IntegralTrends::<M, L> { design };
        Self::settled(value, |memory| {
            trends.input(memory, value, hold);
        })
    }
}

impl<const M: usize, const L: usize> IntegralTrends<M, L> {
    /// Trends of order `M` over spans of `L` samples taken every `sample_time` seconds.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`].
    pub fn try_new(scheme: Scheme, sample_time: f32) -> Result<Self, ConfigError> {
        const { assert!(L > 1, "a span is at least two samples") };
        const { assert_order(M) };
        check_positive("sample_time", sample_time)?;
        Ok(Self {
            design: Design {
                sample_time,
                scheme,
                feedthrough: feedthrough(scheme, sample_time),
                filter: None,
                noise_gain: NoiseGain::ZERO,
                slow_mode: 0.0,
                warm_up: (M * L) as u32 + 1,
                size: Size::Difference { samples: L as f32 },
                plane: Plane::S,
            },
        })
    }

    /// The integral over the last span of ring j, whose newest value has just been put.
    #[inline(always)]
    fn integrate(&self, memory: &mut Span<M, L>, j: usize, held: bool) -> f32 {
        let (newest, leaving) = (memory.past(j, 0), memory.past(j, L));
        let sum = memory.slide(j, newest, leaving);
        // Forward rectangles leave out the newest value, trapezoids half of it.
        let share = if held || matches!(self.design.scheme, Scheme::Goodwin) {
            1.0
        } else {
            0.5
        };
        self.design.sample_time * (sum + share * (leaving - newest))
    }
}

/// Weight of the newest sample in each trend.
fn feedthrough<const M: usize>(scheme: Scheme, sample_time: f32) -> Trends<M> {
    let share = match scheme {
        Scheme::Tustin => 0.5 * sample_time,
        Scheme::Goodwin => 0.0,
    };
    let mut lower = [0.0; M];
    let mut weight = 1.0;
    for w in lower.iter_mut().rev() {
        weight *= share;
        *w = weight;
    }
    Trends { lower, top: 1.0 }
}

impl<const M: usize, const L: usize> sealed::Sealed for IntegralTrends<M, L> {}

impl<const M: usize, const L: usize> TrendOperator<M> for IntegralTrends<M, L> {
    type Memory = Span<M, L>;

    fn output(&self, memory: &mut Span<M, L>, y: f32, _: Form) -> Trends<M> {
        memory.advance();
        let mut value = y;
        let mut trends = Trends {
            lower: [0.0; M],
            top: 0.0,
        };
        for j in 0..M {
            memory.put(j, value);
            let trend = memory.difference(j, M - j, value);
            if j == 0 {
                trends.top = trend;
            } else {
                trends.lower[M - j] = trend;
            }
            value = self.integrate(memory, j, false);
        }
        trends.lower[0] = value;
        trends
    }

    fn input(&self, memory: &mut Span<M, L>, u: f32, hold: Hold) -> [f32; M] {
        if let (Hold::First | Hold::Mean, Scheme::Tustin) = (hold, self.design.scheme) {
            return self.output(memory, u, Form::Position).lower;
        }
        memory.advance();
        memory.put(0, u);
        let mut lower = [0.0; M];
        let mut value = self.integrate(memory, 0, true);
        for j in 1..M {
            memory.put(j, value);
            lower[M - j] = memory.difference(j, M - j, value);
            value = self.integrate(memory, j, false);
        }
        lower[0] = value;
        lower
    }

    fn design(&self) -> &Design<M> {
        &self.design
    }
}
