//! What makes the inputs of an identifier: as they come, or through a valve with a dead zone.

use trendid::Structure;
use trendid::inputs::DeadZone;

use crate::detail::Detail;
use crate::identifier::recursion::{Filtered, FilteredBehindValve, Recursion};
use crate::settings::Settings;

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
    fn update(&mut self, u: &[f32], y: f32) -> Option<trendid::Outcome>;
}

/// Inputs as they come; of `I` inputs of the model the caller gives the first ones, `given` of
/// them; the others are not used.
pub(crate) struct Plain<const M: usize, const N: usize, const I: usize, const D: usize> {
    pub(crate) identifier: Filtered<M, N, I, D>,
    /// Number of inputs of the caller.
    pub(crate) given: usize,
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Plain<M, N, I, D> {
    /// Makes all of it; `own` says which input of the caller an input of the model is.
    pub(crate) fn configure(
        &mut self,
        settings: &Settings,
        structure: Structure<M, N, I>,
        own: [Option<usize>; I],
        given: usize,
    ) -> Result<(), Detail> {
        let config = settings.config(structure, own);
        self.identifier.reconfigure(&config, settings.trends()?)?;
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
    fn update(&mut self, u: &[f32], y: f32) -> Option<trendid::Outcome> {
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
        let &Settings {
            dead_zone_max,
            dead_zone_block,
            ..
        } = settings;
        if !(dead_zone_max > 0.0 && dead_zone_max.is_finite()) {
            return Err(Detail::not_positive("dead_zone_max", dead_zone_max));
        }
        if dead_zone_block == 0 {
            return Err(Detail::not_positive("dead_zone_block", 0.0));
        }
        let config = settings.config(structure, own);
        let unknown = DeadZone::new(0.0, dead_zone_max, dead_zone_block);
        let trends = settings.trends()?;
        Ok(self.identifier.reconfigure(&config, trends, unknown)?)
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
    fn update(&mut self, u: &[f32], y: f32) -> Option<trendid::Outcome> {
        let (command, others) = u.split_first()?;
        if others.len() + 2 != I {
            return None;
        }
        let mut inputs = [0.0; I];
        for (place, value) in inputs.iter_mut().skip(2).zip(others) {
            *place = *value;
        }
        Some(self.identifier.update_inputs(*command, inputs, y))
    }
}
