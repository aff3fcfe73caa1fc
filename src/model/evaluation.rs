//! Output evaluation (9)-(10), one step ahead, and the sums of its errors (11).

use crate::math::sum::Sum;
use crate::model::transfer_function::TransferFunction;
use crate::trends::{Form, Hold, Memory, RawTrends, TrendOperator, Window};

/// Sums of the prediction errors: the indices IQ and IV of equation (11), elsewhere ISE and IAE.
///
/// Each sum has two words, so that it is right to the last digits of f32 after any number of
/// samples.
///
/// # Examples
/// ```
/// let mut errors = trendid::model::PredictionError::new();
/// errors.update(3.0);
/// errors.update(-4.0);
/// assert_eq!((errors.ise(), errors.iae(), errors.samples()), (25.0, 7.0, 2));
/// ```
#[doc(alias = "Quality")]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PredictionError {
    squared: Sum,
    absolute: Sum,
    samples: u32,
}

impl PredictionError {
    /// Nothing evaluated yet.
    pub const fn new() -> Self {
        Self {
            squared: Sum::ZERO,
            absolute: Sum::ZERO,
            samples: 0,
        }
    }

    /// Adds one prediction error `y(k) - y^(k)`, in the unit of y. Cost: 22 instructions.
    #[inline(always)]
    pub fn update(&mut self, error: f32) {
        self.squared.add(error * error);
        self.absolute.add(error.abs());
        self.samples = self.samples.saturating_add(1);
    }

    /// Sum of squared errors, IQ, in the unit of y squared.
    #[doc(alias = "iq")]
    pub const fn ise(&self) -> f32 {
        self.squared.value()
    }

    /// Sum of absolute errors, IV, in the unit of y.
    #[doc(alias = "iv")]
    pub const fn iae(&self) -> f32 {
        self.absolute.value()
    }

    /// Number of errors in the sums; it stops at 2^32 - 1, after 49 days at 1 kHz, the sums do not.
    pub const fn samples(&self) -> u32 {
        self.samples
    }
}

/// Evaluates y(k) one step ahead from past samples and any parameters, as in the paper.
///
/// ```text
/// y^(k) = ( - sum_{i=0}^{m} a_i R~_i y(k) + sum_{i=0}^{m-1} b_i P_i u(k) ) / alpha     (10)
/// alpha = sum_{i=0}^{m} r_0^i a_i,   a_m = 1,   R~_i without its newest sample (9)
/// ```
///
/// Because R_i = r_0^i + R~_i, this is `y(k)` minus the equation error over alpha.
/// The sums of its errors compare structures, orders and delays.
///
/// # Examples
/// ```
/// use trendid::TransferFunction;
/// use trendid::model::OutputEvaluation;
/// use trendid::trends::{RawTrends, Scheme};
/// let mut evaluation = OutputEvaluation::<1, 1>::new(RawTrends::try_new(Scheme::Tustin, 0.1)?);
/// let model = TransferFunction { a: [0.0], b: [[2.0]], constant: 0.0 };
/// assert_eq!(evaluation.update(&model, [1.0], 0.0), None); // the window fills
/// let error = evaluation.update(&model, [1.0], 0.2).unwrap();
/// assert!(error.abs() < 1e-6); // dy/dt = 2 u
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OutputEvaluation<const M: usize, const I: usize> {
    trends: RawTrends<M>,
    holds: [Hold; I],
    output: Window<M>,
    inputs: [Window<M>; I],
    filled: u32,
    errors: PredictionError,
}

impl<const M: usize, const I: usize> OutputEvaluation<M, I> {
    /// Evaluation with the trends of the scheme and sample time of `trends`; all inputs held.
    pub fn new(trends: RawTrends<M>) -> Self {
        Self::with_holds(trends, [Hold::Zero; I])
    }

    /// As [`OutputEvaluation::new`] with the hold of each input.
    pub fn with_holds(trends: RawTrends<M>, holds: [Hold; I]) -> Self {
        let design = trends.design();
        Self {
            holds,
            output: Window::output_at_rest(design, Form::Position, 0.0),
            inputs: holds.map(|hold| Window::input_at_rest(design, hold, 0.0)),
            filled: 0,
            errors: PredictionError::new(),
            trends,
        }
    }

    /// Takes u(k), already delayed, and y(k); gives `y(k) - y^(k)` and adds it to the sums.
    ///
    /// `None` while the window fills, for a sample that is not finite (which is
    /// dropped), and where alpha vanishes.
    pub fn update(&mut self, model: &TransferFunction<M, I>, u: [f32; I], y: f32) -> Option<f32> {
        if !y.is_finite() || !u.iter().all(|u| u.is_finite()) {
            return None;
        }
        let trends = self.trends.output(&mut self.output, y, Form::Position);
        let feedthrough = &self.trends.design().feedthrough;
        let mut error = trends.top;
        let mut alpha = feedthrough.top;
        for i in 0..M {
            error += model.a[i] * trends.lower[i];
            alpha += model.a[i] * feedthrough.lower[i];
        }
        for (c, u) in u.into_iter().enumerate() {
            let lower = self.trends.input(&mut self.inputs[c], u, self.holds[c]);
            for i in 0..M {
                error -= model.b[c][i] * lower[i];
            }
        }
        error -= model.constant;
        if self.filled < self.trends.design().warm_up {
            self.filled += 1;
            return None;
        }
        let error = error / alpha;
        if !error.is_finite() {
            return None;
        }
        self.errors.update(error);
        Some(error)
    }

    /// The sums so far.
    pub const fn prediction_error(&self) -> PredictionError {
        self.errors
    }

    /// Begins the sums anew and keeps the window.
    pub fn restart(&mut self) {
        self.errors = PredictionError::new();
    }
}
