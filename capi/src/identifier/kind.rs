//! What makes the inputs of an identifier: as they come, or through a valve with a dead zone.

use trendid::Structure;
use trendid::inputs::DeadZone;

use crate::detail::Detail;
use crate::identifier::recursion::{Change, Filtered, Recursion};
use crate::settings::Settings;

/// One kind: an identifier of the core and what makes its inputs.
pub(crate) trait Kind {
    type Core: Recursion;
    fn core(&self) -> &Self::Core;
    fn core_mut(&mut self) -> &mut Self::Core;
    fn dead_zone(&self) -> Option<&DeadZone>;
    /// Inputs of the model that are in use.
    fn inputs(&self) -> usize;
    /// Whether the caller gives one input, in every object of the kind.
    const SINGLE: bool;
    /// Takes the inputs of the caller; `None` when their number is not that of the kind.
    fn update(&mut self, u: &[f32], y: f32) -> Option<trendid::Outcome>;
    /// What belongs to the dead zone of a change.
    fn follow(&mut self, change: &Change<'_>);
}

/// Inputs as they come; of `I` inputs of the model the caller gives the first `G`, the others are
/// not used.
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

    fn dead_zone(&self) -> Option<&DeadZone> {
        None
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

    fn follow(&mut self, _: &Change<'_>) {}
}

/// A first input through a valve with a dead zone, which becomes the first two of the model.
pub(crate) struct Valve<const M: usize, const N: usize, const I: usize, const D: usize> {
    pub(crate) identifier: Filtered<M, N, I, D>,
    pub(crate) dead_zone: DeadZone,
    /// The dead zone as constructed.
    pub(crate) unknown: DeadZone,
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
        self.identifier.reconfigure(&config, settings.trends()?)?;
        self.unknown = DeadZone::new(0.0, dead_zone_max, dead_zone_block);
        self.dead_zone = self.unknown;
        Ok(())
    }
}

impl<const M: usize, const N: usize, const I: usize, const D: usize> Kind for Valve<M, N, I, D> {
    const SINGLE: bool = I == 2;
    type Core = Filtered<M, N, I, D>;

    fn core(&self) -> &Self::Core {
        &self.identifier
    }

    fn core_mut(&mut self) -> &mut Self::Core {
        &mut self.identifier
    }

    fn dead_zone(&self) -> Option<&DeadZone> {
        Some(&self.dead_zone)
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
        let pair = self.dead_zone.inputs(*command);
        for (place, value) in inputs.iter_mut().zip(pair.iter().chain(others)) {
            *place = *value;
        }
        let outcome = self.identifier.update_inputs(inputs, y);
        let _ = self.dead_zone.update(&self.identifier);
        Some(outcome)
    }

    fn follow(&mut self, change: &Change<'_>) {
        if let Change::Reset = change {
            self.dead_zone = self.unknown;
        }
    }
}
