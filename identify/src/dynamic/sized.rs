//! A core of one size behind the trait.

use trendid::model::{Physical, PredictionError};
use trendid::trends::{AnyTrends, ExactTrends, FilteredTrends, RawTrends, TrendOperator};
use trendid::{Config, ConfigError, Identifier, Outcome, Structure};

use crate::dynamic::padding::{Padding, numerators};
use crate::dynamic::setup::{DELAY, Filter, INPUTS, Setup};
use crate::estimate::{Estimate, Reading};

/// An [`Identifier`](trendid::Identifier) of any size.
pub trait Recursion: Send + Sync {
    /// Takes the inputs u(k) and y(k); missing inputs count as 0.
    fn update(&mut self, u: &[f32], y: f32) -> Outcome;
    /// The model at this moment.
    fn estimate(&self) -> Estimate;
    /// The parameters of [`estimate`](Self::estimate) alone, at about a sixth of its cost; as many
    /// as there is room for.
    fn theta(&self, to: &mut [f32]);
    /// Sums of the squared and of the absolute prediction errors so far.
    fn prediction_error(&self) -> PredictionError;
    /// Lets the estimate move or holds it.
    fn adapt(&mut self, on: bool);
    /// Begins again from an estimate with its standard deviations.
    ///
    /// # Errors
    /// The value that is not finite, or a length that is not the structure's.
    fn warm_start(&mut self, theta: &[f32], std: &[f32]) -> Result<(), ConfigError>;
}

fn polynomial<const M: usize>(coefficients: &[f32]) -> Result<[f32; M], ConfigError> {
    coefficients
        .try_into()
        .map_err(|_| ConfigError::ParameterCount {
            found: coefficients.len(),
            expected: M,
        })
}

fn trends<const M: usize>(setup: &Setup) -> Result<AnyTrends<M>, ConfigError> {
    Ok(match &setup.filter {
        Filter::None => AnyTrends::Raw(RawTrends::try_new(setup.scheme, setup.sample_time)?),
        Filter::Polynomial(f) => AnyTrends::Filtered(FilteredTrends::from_polynomial(
            setup.scheme,
            setup.sample_time,
            polynomial(f)?,
        )?),
        Filter::Exact { filter, model } => AnyTrends::Exact(
            ExactTrends::from_polynomial(setup.sample_time, polynomial(filter)?)?
                .with_model(polynomial(model)?)?,
        ),
    })
}

fn config<const M: usize, const N: usize>(
    setup: &Setup,
    padding: &Padding,
) -> Result<Config<M, N, INPUTS>, ConfigError> {
    let inputs = padding.inputs;
    let structure = if setup.initial_state {
        Structure::try_with_initial_state(setup.output, inputs, setup.constant)?
    } else {
        Structure::try_new(setup.output, inputs, setup.constant)?
    };
    let mut config = setup.settings.with_structure(structure);
    config.known = [true; N];
    for place in &padding.places {
        if let Some(known) = config.known.get_mut(*place) {
            *known = false;
        }
    }
    Ok(config)
}

pub(super) fn sized<const M: usize, const N: usize>(
    setup: &Setup,
    padding: Padding,
) -> Result<Box<dyn Recursion>, ConfigError> {
    Ok(Box::new(Sized::<_, M, N> {
        identifier: Identifier::try_new(&config::<M, N>(setup, &padding)?, trends(setup)?)?,
        numerators: setup
            .inputs
            .iter()
            .map(|terms| numerators(*terms, M))
            .collect(),
        padding,
    }))
}

/// The core with the numbers of numerator coefficients of its inputs, and which of its parameters
/// are the structure's.
struct Sized<T: TrendOperator<M>, const M: usize, const N: usize> {
    identifier: Identifier<T, M, N, INPUTS, DELAY>,
    numerators: Vec<usize>,
    padding: Padding,
}

impl<T, const M: usize, const N: usize> Recursion for Sized<T, M, N>
where
    T: TrendOperator<M, Memory: Send + Sync> + Send + Sync,
{
    fn update(&mut self, u: &[f32], y: f32) -> Outcome {
        let mut inputs = [0.0; INPUTS];
        for (slot, u) in inputs.iter_mut().zip(u) {
            *slot = *u;
        }
        self.identifier.update_inputs(inputs, y)
    }

    fn estimate(&self) -> Estimate {
        let found = self.identifier.estimate();
        let transfer = found.transfer_function();
        let reading = Physical::of(&transfer, 0);
        let poles = transfer.poles();
        Estimate {
            theta: wide(&self.padding.of(&found.theta())),
            sigma: wide(&self.padding.of(&found.std())),
            covariance: (self.padding.of(&found.covariance()).iter())
                .map(|row| wide(&self.padding.of(row)))
                .collect(),
            a: wide(&transfer.a),
            b: transfer
                .b
                .iter()
                .zip(&self.numerators)
                .map(|(b, n)| wide(&b[..*n]))
                .collect(),
            constant: f64::from(transfer.constant),
            reading: Reading {
                gain: reading.gain.map(f64::from),
                omega0: reading.omega0.map(f64::from),
                damping: reading.damping.map(f64::from),
                time_constants: wide(
                    &reading
                        .time_constants
                        .into_iter()
                        .flatten()
                        .collect::<Vec<_>>(),
                ),
                poles: poles.map(|poles| {
                    let wide = |p: &trendid::model::Pole| (f64::from(p.re), f64::from(p.im));
                    poles.iter().map(wide).collect()
                }),
                stable: reading.stable,
            },
            reading_sigma: found.physical_std().map(|s| s.map(f64::from)),
        }
    }

    fn theta(&self, to: &mut [f32]) {
        for (to, theta) in to.iter_mut().zip(self.padding.of(&self.identifier.theta())) {
            *to = theta;
        }
    }

    fn prediction_error(&self) -> PredictionError {
        self.identifier.prediction_error()
    }

    fn adapt(&mut self, on: bool) {
        self.identifier.adapt(on);
    }

    fn warm_start(&mut self, theta: &[f32], std: &[f32]) -> Result<(), ConfigError> {
        let theta = self.padding.filled(theta)?;
        let std = self.padding.filled(std)?;
        let done = self.identifier.warm_start(theta, std);
        done.map_err(|error| self.padding.named(error))
    }
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().copied().map(f64::from).collect()
}
