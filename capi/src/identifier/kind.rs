//! What makes the inputs of an identifier: as they come, or through a valve with a dead zone.

use trendid::identifier::Refusal;
use trendid::inputs::DeadZone;
use trendid::{Outcome, Structure};

use crate::detail::Detail;
use crate::identifier::recursion::{Filtered, FilteredBehindValve, Recursion};
use crate::settings::{Settings, Takes, of_caller};

/// One kind: an identifier of the core and what makes its inputs.
pub(crate) trait Kind {
    type Core: Recursion;
    fn core(&self) -> &Self::Core;
    fn core_mut(&mut self) -> &mut Self::Core;
    /// Inputs of the model that are in use.
    fn inputs(&self) -> usize;
    /// Whether the caller gives one input, in every object of the kind.
    const SINGLE: bool;
    /// Takes the inputs of the caller; `None` when their number is not that of the kind.
    fn update(&mut self, u: &[f32], y: f32) -> Option<Outcome>;
}

/// Inputs as they come; of `I` inputs of the model the caller gives the first ones, `given` of
/// them; the others are not used.
pub(crate) struct Plain<const M: usize, const N: usize, const I: usize, const D: usize> {
    pub(crate) identifier: Filtered<M, N, I, D>,
    /// Number of inputs of the caller.
    pub(crate) given: usize,
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Plain<M, N, I, D> {
    /// Makes all of it; `own` says which input of the caller an input of the model is, `sign` the
    /// first that may be the sign of the velocity.
    pub(crate) fn configure(
        &mut self,
        settings: &Settings,
        structure: Structure<M, N, I>,
        own: [Option<usize>; I],
        given: usize,
        sign: usize,
    ) -> Result<(), Detail> {
        settings.check(&Takes {
            inputs: given,
            sign,
            delay: D,
            parameters: N,
            constant: structure.constant(),
            dead_zone: false,
        })?;
        let config = settings.config(structure, own);
        let done = self.identifier.reconfigure(&config, settings.trends()?);
        done.map_err(|error| of_caller(error, &own))?;
        self.given = given;
        Ok(())
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Kind for Plain<M, N, I, D> {
    const SINGLE: bool = I == 1;
    type Core = Filtered<M, N, I, D>;

    fn core(&self) -> &Self::Core {
        &self.identifier
    }

    fn core_mut(&mut self) -> &mut Self::Core {
        &mut self.identifier
    }

    fn inputs(&self) -> usize {
        self.given
    }

    #[inline(always)]
    fn update(&mut self, u: &[f32], y: f32) -> Option<Outcome> {
        let wanted = if I == 1 { 1 } else { self.given };
        if u.len() != wanted {
            return None;
        }
        let mut inputs = [0.0; I];
        for (place, value) in inputs.iter_mut().zip(u) {
            *place = *value;
        }
        Some(self.identifier.update_inputs(inputs, y))
    }
}

/// A first input through a valve with a dead zone, which becomes the first two of the model.
pub(crate) struct Valve<const M: usize, const N: usize, const I: usize, const D: usize> {
    pub(crate) identifier: FilteredBehindValve<M, N, I, D>,
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Valve<M, N, I, D> {
    /// Makes all of it; `own` says which input of the caller an input of the model is, `None` for
    /// the sign of the command.
    pub(crate) fn configure(
        &mut self,
        settings: &Settings,
        structure: Structure<M, N, I>,
        own: [Option<usize>; I],
    ) -> Result<(), Detail> {
        settings.check(&Takes {
            inputs: I.saturating_sub(1),
            sign: 1,
            delay: D,
            parameters: N,
            constant: structure.constant(),
            dead_zone: true,
        })?;
        let (largest, block) = settings.dead_zone_limits();
        let unknown = DeadZone::new(settings.dead_zone, largest, block);
        let mut config = settings.config(structure, own);
        let command = settings.initial_input[0];
        let made = match command.is_finite() {
            true => unknown.inputs(command),
            // Refused by the core.
            false => [command; 2],
        };
        for (place, value) in config.initial_input.iter_mut().zip(made) {
            *place = value;
        }
        let trends = settings.trends()?;
        let done = self.identifier.reconfigure(&config, trends, unknown);
        Ok(done.map_err(|error| of_caller(error, &own))?)
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Kind for Valve<M, N, I, D> {
    const SINGLE: bool = I == 2;
    type Core = FilteredBehindValve<M, N, I, D>;

    fn core(&self) -> &Self::Core {
        &self.identifier
    }

    fn core_mut(&mut self) -> &mut Self::Core {
        &mut self.identifier
    }

    fn inputs(&self) -> usize {
        I
    }

    #[inline(always)]
    fn update(&mut self, u: &[f32], y: f32) -> Option<Outcome> {
        let (command, others) = u.split_first()?;
        if others.len() + 2 != I {
            return None;
        }
        let mut inputs = [0.0; I];
        for (place, value) in inputs.iter_mut().skip(2).zip(others) {
            *place = *value;
        }
        let outcome = self.identifier.update_inputs(*command, inputs, y);
        Some(match outcome {
            // The sign of the command is no input of the caller.
            Outcome::Refused(Refusal::Input(input)) => {
                Outcome::Refused(Refusal::Input(input.saturating_sub(1)))
            }
            other => other,
        })
    }
}
