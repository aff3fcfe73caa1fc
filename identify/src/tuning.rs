//! The choices of a run over a record: filter and delay.

use trendid::trends::{Scheme, polynomial_of_poles};

use crate::dynamic::Filter;
use crate::estimate::Estimate;

/// Rates up to this many per sample have exact trends (they end at 2).
pub const FASTEST: f64 = 1.8;

/// Filter and delay, the two choices that the signals can make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning {
    /// All filter poles at `-pole` rad/s; `None` for raw trends.
    pub pole: Option<f64>,
    /// The filter 1/A of a model in place of these poles.
    pub model: Option<ModelFilter>,
    /// Delay in samples, also between two of them.
    pub delay: f64,
}

/// The filter 1/A with the poles of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelFilter {
    /// f_0 .. f_{m-1}, then zeros.
    coefficients: [f32; 4],
    order: usize,
    /// Slowest decay in 1/s.
    slowest: f64,
    /// Largest distance of a pole from zero, in rad/s.
    fastest: f64,
}

impl ModelFilter {
    /// The filter of an estimate; a pole at 0 gives way to one at `-pole`.
    ///
    /// `None` unless all other poles are stable.
    pub fn of(estimate: &Estimate, integrator: bool, pole: f64) -> Option<Self> {
        let order = estimate.a.len();
        let poles = estimate.reading.poles.as_ref()?;
        let rates = poles.iter().skip(usize::from(integrator));
        let slowest = rates
            .map(|(re, _)| -*re)
            .chain(integrator.then_some(pole))
            .fold(f64::INFINITY, f64::min);
        if !(slowest > 0.0) {
            return None;
        }
        let mut coefficients = [0.0; 4];
        for (i, (slot, a)) in coefficients.iter_mut().zip(&estimate.a).enumerate() {
            // A/s (s + pole)
            let above = estimate.a.get(i + 1).copied().unwrap_or(1.0);
            *slot = (if integrator { a + pole * above } else { *a }) as f32;
        }
        Some(Self {
            coefficients,
            order,
            slowest,
            fastest: estimate.fastest(),
        })
    }

    /// f_0 .. f_{m-1}.
    pub fn coefficients(&self) -> &[f32] {
        &self.coefficients[..self.order]
    }
}

impl Tuning {
    /// The slowest filter pole in rad/s; `None` for raw trends.
    pub fn slowest(&self) -> Option<f64> {
        self.pole
            .map(|pole| self.model.map_or(pole, |filter| filter.slowest))
    }

    /// The fastest filter pole in rad/s; `None` for raw trends.
    pub fn fastest(&self) -> Option<f64> {
        self.pole
            .map(|pole| self.model.map_or(pole, |filter| filter.fastest))
    }

    /// The trends: exact wherever there are any, that is Tustin's with poles within the sampling.
    ///
    /// `denominator` is the one whose numerators the inputs get; without it the filter itself.
    pub fn filter(
        &self,
        scheme: Scheme,
        order: usize,
        dt: f64,
        denominator: Option<&[f64]>,
    ) -> Filter {
        let (Some(pole), Some(fastest)) = (self.pole, self.fastest()) else {
            return Filter::None;
        };
        let filter = match self.model {
            Some(filter) => filter.coefficients().to_vec(),
            None => binomial(pole, order),
        };
        if scheme != Scheme::Tustin || fastest * dt > FASTEST {
            return Filter::Polynomial(filter);
        }
        let denominator = match denominator {
            Some(a) => a.iter().map(|a| *a as f32).collect(),
            None => filter.clone(),
        };
        Filter::Exact {
            filter,
            model: denominator,
        }
    }
}

/// Coefficients f_0 .. f_{m-1} of `(s + pole)^m`.
///
/// An order outside 1..=4 has none.
pub fn binomial(pole: f64, m: usize) -> Vec<f32> {
    fn of<const M: usize>(pole: f64) -> Vec<f32> {
        polynomial_of_poles([pole as f32; M]).to_vec()
    }
    match m {
        1 => of::<1>(pole),
        2 => of::<2>(pole),
        3 => of::<3>(pole),
        4 => of::<4>(pole),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_is_the_power_of_one_pole() {
        assert_eq!(binomial(2.0, 3), [8.0, 12.0, 6.0]);
        assert_eq!(binomial(5.0, 1), [5.0]);
    }
}
