//! The identifiers of the core behind one face, whatever their sizes.

use core::mem::MaybeUninit;

use trendid::estimation::Parameter as CoreParameter;
use trendid::identifier::Identifier as Core;
use trendid::inputs::{DeadZone, Valved};
use trendid::trends::FilteredTrends;
use trendid::{ConfigError, TransferFunction};

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::outputs::{Estimate, Parameter, Pole, Status, Way};

/// The core behind the default filter.
pub(crate) type Filtered<const M: usize, const N: usize, const I: usize, const D: usize> =
    Core<FilteredTrends<M>, M, N, I, D>;

/// The same behind a valve with a dead zone.
pub(crate) type FilteredBehindValve<
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
> = Valved<FilteredTrends<M>, M, N, I, D>;

/// What the main loop asks of an identifier.
pub(crate) enum Change<'a> {
    Skip(u32),
    Reset,
    RestartTrends,
    WarmStart(&'a [f32], &'a [f32]),
    SetNominal,
    Adapt(bool),
    Retune(f32),
}

/// The identifiers of the core, whatever their sizes.
pub(crate) trait Recursion {
    fn change(&mut self, change: Change<'_>) -> Result<(), Detail>;
    fn theta(&self, theta: &mut [f32]) -> Result<(), Error>;
    fn estimate(&self, to: &mut MaybeUninit<Estimate>);
    fn covariance(&self, covariance: &mut [f32]) -> Result<(), Error>;
    fn parameters(&self, parameters: &mut [Parameter]) -> Result<(), Error>;
    fn poles(&self, poles: &mut [Pole]) -> Result<(), Error>;
    fn status(&self) -> Status;
}

/// Copies into a list of the caller that has exactly this length.
#[inline(always)]
pub(super) fn copy<T: Copy>(from: &[T], to: &mut [T]) -> Result<(), Error> {
    if from.len() != to.len() {
        return Err(Error::Length);
    }
    for (place, value) in to.iter_mut().zip(from) {
        *place = *value;
    }
    Ok(())
}

/// A list of the caller as an array.
pub(super) fn array<const N: usize>(list: &[f32]) -> Result<[f32; N], Detail> {
    list.try_into().map_err(|_| Error::Length.into())
}

/// The estimate of the core, once in the image.
#[inline(never)]
fn found<const M: usize, const N: usize, const I: usize, const D: usize>(
    identifier: &Filtered<M, N, I, D>,
) -> trendid::Estimate<M, N, I> {
    identifier.estimate()
}

/// The same behind a valve.
#[inline(never)]
fn found_behind_valve<const M: usize, const N: usize, const I: usize, const D: usize>(
    identifier: &FilteredBehindValve<M, N, I, D>,
) -> trendid::Estimate<M, N, I> {
    identifier.estimate()
}

/// Carries out a change on either.
macro_rules! carry_out {
    ($identifier:ident, $change:ident) => {{
        let done: Result<(), ConfigError> = match $change {
            Change::WarmStart(theta, std) => $identifier.warm_start(array(theta)?, array(std)?),
            Change::Retune(omega0) => $identifier.retune_to(omega0),
            Change::Skip(samples) => {
                $identifier.skip(samples);
                Ok(())
            }
            Change::Reset => {
                $identifier.reset();
                Ok(())
            }
            Change::RestartTrends => {
                $identifier.restart_trends();
                Ok(())
            }
            Change::SetNominal => {
                $identifier.set_nominal();
                Ok(())
            }
            Change::Adapt(on) => {
                $identifier.adapt(on);
                Ok(())
            }
        };
        Ok(done?)
    }};
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Recursion
    for Filtered<M, N, I, D>
{
    fn change(&mut self, change: Change<'_>) -> Result<(), Detail> {
        carry_out!(self, change)
    }

    #[inline(always)]
    fn theta(&self, theta: &mut [f32]) -> Result<(), Error> {
        copy(&Core::theta(self), theta)
    }

    #[inline(always)]
    fn estimate(&self, to: &mut MaybeUninit<Estimate>) {
        Estimate::tell(&found(self), to);
    }

    fn covariance(&self, covariance: &mut [f32]) -> Result<(), Error> {
        copy(found(self).covariance().as_flattened(), covariance)
    }

    fn parameters(&self, parameters: &mut [Parameter]) -> Result<(), Error> {
        copy(
            &self.structure().parameters().map(Parameter::from),
            parameters,
        )
    }

    fn poles(&self, poles: &mut [Pole]) -> Result<(), Error> {
        poles_of(&found(self), poles)
    }

    fn status(&self) -> Status {
        status(self, None)
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Recursion
    for FilteredBehindValve<M, N, I, D>
{
    fn change(&mut self, change: Change<'_>) -> Result<(), Detail> {
        carry_out!(self, change)
    }

    #[inline(always)]
    fn theta(&self, theta: &mut [f32]) -> Result<(), Error> {
        Recursion::theta(self.identifier(), theta)
    }

    #[inline(always)]
    fn estimate(&self, to: &mut MaybeUninit<Estimate>) {
        Estimate::tell(&found_behind_valve(self), to);
    }

    fn covariance(&self, covariance: &mut [f32]) -> Result<(), Error> {
        copy(
            found_behind_valve(self).covariance().as_flattened(),
            covariance,
        )
    }

    fn parameters(&self, parameters: &mut [Parameter]) -> Result<(), Error> {
        Recursion::parameters(self.identifier(), parameters)
    }

    fn poles(&self, poles: &mut [Pole]) -> Result<(), Error> {
        poles_of(&found_behind_valve(self), poles)
    }

    fn status(&self) -> Status {
        status(self.identifier(), Some(self.dead_zone()))
    }
}

/// The poles of an estimate: of its denominator alone, so that the transfer function of the
/// estimate has one caller, and stays in its place there.
pub(super) fn poles_of<const M: usize, const N: usize, const I: usize>(
    found: &trendid::Estimate<M, N, I>,
    poles: &mut [Pole],
) -> Result<(), Error> {
    let mut denominator = TransferFunction::<M, 0> {
        a: [0.0; M],
        b: [],
        constant: 0.0,
    };
    let parameters = found.structure().parameters();
    for (parameter, value) in parameters.into_iter().zip(found.theta()) {
        if let CoreParameter::Output { power } = parameter
            && let Some(place) = denominator.a.get_mut(power)
        {
            *place = value;
        }
    }
    let found = denominator.poles().ok_or(Error::NotYet)?;
    copy(&found.map(Pole::from), poles)
}

pub(super) fn status<const M: usize, const N: usize, const I: usize, const D: usize>(
    identifier: &Filtered<M, N, I, D>,
    dead_zone: Option<&DeadZone>,
) -> Status {
    let errors = identifier.prediction_error();
    let noise_std = identifier.noise_std();
    Status {
        prediction: identifier.prediction(),
        noise_std: noise_std.unwrap_or(0.0),
        ise: errors.ise(),
        iae: errors.iae(),
        samples: errors.samples(),
        replaced: identifier.replaced(),
        changes: identifier.changes(),
        dead_zone: dead_zone.map_or(0.0, DeadZone::delta),
        dead_zone_std: dead_zone.map_or(0.0, DeadZone::std),
        blocks: 0.0,
        has_noise_std: noise_std.is_some(),
        way: Way::Recursion,
    }
}
