//! The core's trends of one signal behind an order that is known only at run time.

use trendid::trends::{
    AnyTrends, ExactTrends, FilteredTrends, Form, Hold, Memory, Scheme, TrendOperator,
};
use trendid::{ConfigError, trends::AnyMemory};

use crate::instruments::numerators::Numerators;
pub(crate) use crate::instruments::numerators::Values;
use crate::polynomials::{Pole, from_roots, roots};

/// Trends of one signal, whatever their order.
pub(crate) trait Lane: Send {
    /// Trends 0 .. m of a sampled signal.
    fn output(&mut self, y: f32) -> Values;
    /// Trends 0 .. m-1 of an input.
    fn input(&mut self, u: f32) -> Values;
}

/// A filter polynomial with the numerators of a plant, of one of the orders 1 to 4.
pub(crate) trait Design: Send {
    /// A lane for a sampled signal that has always had the value of its first sample.
    fn of_output(&self, form: Form, first: f32) -> Box<dyn Lane>;
    /// A lane for an input that was zero.
    fn of_input(&self, hold: Hold) -> Box<dyn Lane>;
    /// f_0 .. f_{m-1} of the filter in the plane of the trends.
    fn filter(&self) -> Vec<f64>;
    /// A model in the plane of the trends as one of the s plane: its denominator, and the factor
    /// from the numerators found to those of s; `zeros` states whether an input has a b_i beyond
    /// b_0. `None` where a pole is too fast for the sampling of exact trends.
    fn to_s_plane(&self, a: &[f64], integrators: usize, zeros: bool) -> Option<(Vec<f64>, f64)>;
}

struct Operator<const M: usize> {
    trends: AnyTrends<M>,
    /// The chain of exact trends with their numerators.
    exact: Option<(AnyTrends<M>, Numerators)>,
    /// As it is, and as the trends take it.
    sample_time: (f64, f32),
}

struct Signal<const M: usize> {
    trends: AnyTrends<M>,
    /// Those of an input behind exact trends.
    numerators: Option<Numerators>,
    memory: AnyMemory<M>,
    form: Form,
    hold: Hold,
}

/// Trends behind the filter `filter` of the s plane, exact for the denominator `model` where there
/// is one.
///
/// # Errors
/// The core's refusal of the filter; an order outside 1 to 4.
pub(crate) fn design(
    dt: f64,
    filter: &[f64],
    model: Option<&[f64]>,
) -> Result<Box<dyn Design>, ConfigError> {
    match filter.len() {
        1 => sized::<1>(dt, filter, model),
        2 => sized::<2>(dt, filter, model),
        3 => sized::<3>(dt, filter, model),
        4 => sized::<4>(dt, filter, model),
        found => Err(ConfigError::ParameterCount { found, expected: 4 }),
    }
}

fn narrow<const M: usize>(values: &[f64]) -> [f32; M] {
    let mut narrow = [0.0; M];
    for (slot, value) in narrow.iter_mut().zip(values) {
        *slot = *value as f32;
    }
    narrow
}

fn sized<const M: usize>(
    dt: f64,
    filter: &[f64],
    model: Option<&[f64]>,
) -> Result<Box<dyn Design>, ConfigError> {
    let sample_time = (dt, dt as f32);
    let plain = |filter| FilteredTrends::from_polynomial(Scheme::Tustin, sample_time.1, filter);
    let Some(model) = model else {
        return Ok(Box::new(Operator::<M> {
            trends: AnyTrends::Filtered(plain(narrow(filter))?),
            exact: None,
            sample_time,
        }));
    };
    let own = ExactTrends::<M>::from_polynomial(sample_time.1, narrow(filter))?;
    // A model that is too fast for the sampling leaves the numerators of the filter.
    let (exact, model) = match own.with_model(narrow(model)) {
        Ok(exact) => (exact, model),
        Err(_) => (own, filter),
    };
    let image = exact.design().filter.unwrap_or([0.0; M]);
    let numerators = Numerators::of(model, &image.map(f64::from), (dt, f64::from(sample_time.1)));
    Ok(Box::new(Operator::<M> {
        exact: Some((AnyTrends::Filtered(plain(image)?), numerators)),
        trends: AnyTrends::Exact(exact),
        sample_time,
    }))
}

impl<const M: usize> Design for Operator<M> {
    fn of_output(&self, form: Form, first: f32) -> Box<dyn Lane> {
        Box::new(Signal {
            trends: self.trends.clone(),
            numerators: None,
            memory: Memory::output_at_rest(self.trends.design(), form, first),
            form,
            hold: Hold::Zero,
        })
    }

    fn of_input(&self, hold: Hold) -> Box<dyn Lane> {
        let (trends, numerators) = match &self.exact {
            Some((chain, numerators)) => (chain, Some(numerators.clone())),
            None => (&self.trends, None),
        };
        Box::new(Signal {
            trends: trends.clone(),
            numerators,
            memory: Memory::input_at_rest(trends.design(), hold, 0.0),
            form: Form::Position,
            hold,
        })
    }

    fn filter(&self) -> Vec<f64> {
        let filter = self.trends.design().filter.unwrap_or([0.0; M]);
        filter.iter().copied().map(f64::from).collect()
    }

    fn to_s_plane(&self, a: &[f64], integrators: usize, zeros: bool) -> Option<(Vec<f64>, f64)> {
        let design = self.trends.design();
        match (
            design.to_s_plane(&narrow(a), integrators, zeros),
            &self.exact,
        ) {
            (Some(_), Some((_, numerators))) => {
                let exact = poles_of_s_plane(a, integrators, self.sample_time)?;
                // The gain behind the integrators stays.
                let gain = match (a.get(integrators), exact.get(integrators)) {
                    (Some(found), Some(exact)) if *found != 0.0 => exact / found,
                    _ => 1.0,
                };
                Some((exact, numerators.at_rest() * gain))
            }
            (Some(mapped), None) => {
                let a = mapped.a.iter().copied().map(f64::from).collect();
                Some((a, f64::from(mapped.numerator)))
            }
            (None, Some(_)) => None,
            (None, None) => Some((a.to_vec(), 1.0)),
        }
    }
}

/// The denominator with the poles `p = (2/h) artanh(h' gamma/2)` of those of `a`, h the sample time
/// and h' that of the trends, which is rounded: the map of the core without its rounding.
fn poles_of_s_plane(a: &[f64], integrators: usize, (h, rounded): (f64, f32)) -> Option<Vec<f64>> {
    let half = 0.5 * f64::from(rounded);
    let poles = roots(&a[integrators..])?;
    let map = |(re, im): Pole| {
        // artanh z = ln((1 + z)/(1 - z))/2
        let (x, y) = (half * re, half * im);
        let ratio = (1.0 - x).powi(2) + y * y;
        let re = (4.0 * x / ratio).ln_1p() / (2.0 * h);
        let im = (2.0 * y).atan2(1.0 - x * x - y * y) / h;
        re.is_finite().then_some((re, im))
    };
    let poles: Option<Vec<Pole>> = poles.into_iter().map(map).collect();
    let mut mapped = vec![0.0; integrators];
    mapped.extend(from_roots(&poles?));
    Some(mapped)
}

impl<const M: usize> Lane for Signal<M> {
    fn output(&mut self, y: f32) -> Values {
        let trends = self.trends.output(&mut self.memory, y, self.form);
        let mut values = wide(&trends.lower);
        values[M] = f64::from(trends.top);
        values
    }

    fn input(&mut self, u: f32) -> Values {
        let trends = self.trends.input(&mut self.memory, u, self.hold);
        match &self.numerators {
            Some(numerators) => numerators.apply(&trends, u, self.hold),
            None => wide(&trends),
        }
    }
}

fn wide(trends: &[f32]) -> Values {
    let mut values = Values::default();
    for (slot, trend) in values.iter_mut().zip(trends) {
        *slot = f64::from(*trend);
    }
    values
}
