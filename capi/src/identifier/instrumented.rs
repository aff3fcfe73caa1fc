//! The identifiers with instruments beside the recursion behind the face of the others.

use core::mem::MaybeUninit;

use trendid::Structure;
use trendid::estimation::Terms;
use trendid::instruments::{Found, Instrumented as Core, Way as CoreWay};
use trendid::trends::FilteredTrends;

use crate::detail::Detail;
use crate::error::Error;
use crate::identifier::kind::Kind;
use crate::identifier::outputs::{Estimate, Parameter, Pole, Status, Way};
use crate::identifier::recursion::{Change, Recursion, array, copy, poles_of, status};
use crate::settings::{Settings, Takes};

/// Inputs of the model: the command, and one without a term. So the code of its read-outs is of
/// other sizes than that of the kinds without instruments: shared, it would be called there where
/// it now stands in its place.
const INPUTS: usize = 2;

/// A servo, and that input.
const fn servo<const M: usize, const N: usize>() -> Structure<M, N, INPUTS> {
    let inputs = [Terms::of(&[0]), Terms::NONE];
    match Structure::try_with_initial_state(Terms::between(1, M), inputs, true) {
        Ok(structure) => structure,
        Err(_) => panic!("the sizes contradict the terms"),
    }
}

/// Order 2, and order 3.
pub(crate) const SERVO2: Structure<2, 4, INPUTS> = servo();
pub(crate) const SERVO3: Structure<3, 5, INPUTS> = servo();

/// One command as it comes; `R` rows of instruments.
pub(crate) struct Instrumented<const M: usize, const N: usize, const R: usize, const D: usize> {
    identifier: Core<FilteredTrends<M>, M, N, INPUTS, R, D>,
}

impl<const M: usize, const N: usize, const R: usize, const D: usize> Instrumented<M, N, R, D> {
    /// Makes all of it.
    pub(crate) fn configure(
        &mut self,
        settings: &Settings,
        structure: Structure<M, N, INPUTS>,
    ) -> Result<(), Detail> {
        settings.check(&Takes {
            inputs: 1,
            sign: 1,
            delay: D,
            parameters: N,
            constant: structure.constant(),
            dead_zone: false,
        })?;
        let config = settings.config(structure, [Some(0), Some(1)]);
        self.identifier = Core::try_new(&config, settings.trends()?)?;
        Ok(())
    }
}

impl<const M: usize, const N: usize, const R: usize, const D: usize> Kind
    for Instrumented<M, N, R, D>
{
    const SINGLE: bool = true;
    type Core = Core<FilteredTrends<M>, M, N, INPUTS, R, D>;

    fn core(&self) -> &Self::Core {
        &self.identifier
    }

    fn core_mut(&mut self) -> &mut Self::Core {
        &mut self.identifier
    }

    fn inputs(&self) -> usize {
        1
    }

    #[inline(always)]
    fn update(&mut self, u: &[f32], y: f32) -> Option<trendid::Outcome> {
        match *u {
            [u] => Some(self.identifier.update_inputs([u, 0.0], y)),
            _ => None,
        }
    }
}

/// The reading of the core, once in the image.
#[inline(never)]
fn found<const M: usize, const N: usize, const R: usize, const D: usize>(
    identifier: &Core<FilteredTrends<M>, M, N, INPUTS, R, D>,
) -> Found<M, N, INPUTS> {
    identifier.estimate()
}

impl<const M: usize, const N: usize, const R: usize, const D: usize> Recursion
    for Core<FilteredTrends<M>, M, N, INPUTS, R, D>
{
    fn change(&mut self, change: Change<'_>) -> Result<(), Detail> {
        match change {
            Change::Skip(samples) => self.skip(samples),
            Change::Reset => self.reset(),
            Change::RestartTrends => self.restart_trends(),
            Change::Adapt(on) => self.adapt(on),
            Change::WarmStart(theta, std) => self.warm_start(array(theta)?, array(std)?)?,
            Change::SetNominal => self.set_nominal(),
            Change::Retune(_) => return Err(Error::NotOffered.into()),
        }
        Ok(())
    }

    fn theta(&self, theta: &mut [f32]) -> Result<(), Error> {
        copy(&found(self).estimate.theta(), theta)
    }

    fn estimate(&self, to: &mut MaybeUninit<Estimate>) {
        Estimate::tell(&found(self).estimate, to);
    }

    fn covariance(&self, covariance: &mut [f32]) -> Result<(), Error> {
        let found = found(self);
        copy(found.estimate.covariance().as_flattened(), covariance)
    }

    fn parameters(&self, parameters: &mut [Parameter]) -> Result<(), Error> {
        let structure = self.identifier().structure();
        copy(&structure.parameters().map(Parameter::from), parameters)
    }

    fn poles(&self, poles: &mut [Pole]) -> Result<(), Error> {
        poles_of(&found(self).estimate, poles)
    }

    fn status(&self) -> Status {
        let found = found(self);
        Status {
            way: match found.way {
                CoreWay::Instruments => Way::Instruments,
                CoreWay::TooFewBlocks => Way::TooFewBlocks,
                CoreWay::WeakInstruments => Way::WeakInstruments,
                _ => Way::Recursion,
            },
            blocks: found.effective_blocks,
            ..status(self.identifier(), None)
        }
    }
}
