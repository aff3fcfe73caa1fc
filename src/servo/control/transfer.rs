//! A change of gains without a step of the command.

use crate::math::within;
use crate::servo::control::margins::Margins;
use crate::servo::control::poles::Poles;
use crate::servo::model::Model;

/// Gains that come into force at the next sample, and what is left of the last change.
///
/// The difference of the commands before and after a change is kept, and fades.
///
/// Known as: bumpless transfer (Astrom and Hagglund 2006).
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Transfer {
    arriving: Arriving,
    /// What is left of the last change, as a command.
    trace: f32,
}

/// What comes into force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Arriving {
    pub(crate) model: Option<Model>,
    pub(crate) poles: Option<(Poles, Option<Margins>)>,
    /// Factor on the bandwidth.
    pub(crate) factor: Option<f32>,
}

impl Transfer {
    pub(crate) const fn model(&mut self, model: Model) {
        self.arriving.model = Some(model);
    }

    pub(crate) const fn poles(&mut self, poles: Poles, margins: Option<Margins>) {
        self.arriving.poles = Some((poles, margins));
    }

    pub(crate) const fn factor(&mut self, factor: f32) {
        self.arriving.factor = Some(factor);
    }

    /// No model arrives any more.
    pub(crate) const fn forget_model(&mut self) {
        self.arriving.model = None;
    }

    /// Nothing is left of earlier changes.
    pub(crate) const fn settle(&mut self) {
        self.trace = 0.0;
    }

    /// A sample on: a share of the trace fades, at most so much.
    #[inline]
    pub(crate) fn fade(&mut self, share: f32, most: f32) -> f32 {
        self.trace -= within(share * self.trace, most);
        self.trace
    }

    /// Whether something comes into force with the next sample.
    #[inline]
    pub(crate) const fn has_arriving(&self) -> bool {
        let Arriving {
            model,
            poles,
            factor,
        } = &self.arriving;
        model.is_some() || poles.is_some() || factor.is_some()
    }

    /// What comes into force in this sample.
    #[inline]
    pub(crate) fn take(&mut self) -> Option<Arriving> {
        self.has_arriving()
            .then(|| core::mem::take(&mut self.arriving))
    }

    /// Keeps the difference of the commands before and after a change; gives the command. Within
    /// the full command on both sides: beyond it the valve saturates anyway.
    #[inline]
    pub(crate) fn keep(&mut self, before: f32, after: f32) -> f32 {
        self.trace = within(before, 1.0) - after;
        after + self.trace
    }
}
