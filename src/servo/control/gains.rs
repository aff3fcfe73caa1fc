//! The gains in force: those that a model needs, and what puts others in their place.

use crate::error::positive;
use crate::math::sqrt;
use crate::servo::control::controller::Controller;
use crate::servo::control::margins::Margins;
use crate::servo::control::place::stiffening;
use crate::servo::control::poles::Poles;
use crate::servo::control::rest::RestDesign;
use crate::servo::control::standing::lead;
use crate::servo::control::tuning::{OBSERVER_STEP, Tuning};
use crate::servo::design::{EstimatorDesign, TuningDesign};
use crate::servo::model::Model;

/// Deflections `friction / a1` over resolution and noise from which friction counts as holding: it
/// holds more than the sensor sees.
const STICKY: f32 = 10.0;
/// Window over the deflection that friction holds, with room to rest in the dead zone and without.
const WINDOW: [f32; 2] = [1.0, 0.2];
/// Errors of dead zone and offset over their values, for the window without friction.
const VALVE_ERROR: [f32; 2] = [0.3, 0.2];

impl Controller {
    /// Searches the poles for a model at once: not for the 1 ms path.
    pub(crate) fn search(&mut self, model: &Model) {
        let mut tuning = Tuning::new(&self.design.tuning, model);
        while !tuning.step() {}
        (self.poles, self.margins) = tuning.poles();
        self.found_for = sqrt(model.a1);
    }

    /// Goes over to a model.
    pub(super) fn tune(&mut self, model: Model) {
        self.frequency = sqrt(model.a1);
        let fastest = OBSERVER_STEP / self.design.estimator.sample_time;
        let poles = self
            .poles
            .on(self.frequency / self.found_for, self.frequency, fastest);
        self.estimator.tune(model, poles.derated(self.factor));
        self.anchor.tune(poles.observer);
        let EstimatorDesign {
            travel,
            dead_volume,
            imbalance,
            ..
        } = self.design.estimator;
        let stiffening = stiffening(dead_volume);
        (self.load).tune(model.a1, stiffening, travel.length(), imbalance);
        let deflection = model.friction / model.a1;
        let grain = self.design.grain;
        let sticky = deflection > STICKY * grain;
        if !sticky {
            // From now on no position reaches it: a place still held would be held for ever.
            self.anchor.restart();
        }
        let room = model.dead_zone > 0.3 * model.offset.abs() + 0.002;
        let most = if sticky {
            WINDOW[usize::from(!room)] * deflection
        } else {
            let [dead_zone, offset] = VALVE_ERROR;
            let flow = dead_zone * model.dead_zone + offset * model.offset.abs();
            2.0 * flow * model.b0 / (model.a1 * poles.bandwidth)
        };
        let least = self.design.rest_window;
        self.rest.redesign(&RestDesign {
            least,
            most: if most > least { most } else { least },
            sticky,
            lead: if sticky {
                0.0
            } else {
                lead(&model, self.frequency)
            },
        });
    }

    /// Multiplies the bandwidth by a factor of 0 to 1 from the next sample on, bumpless.
    pub(crate) const fn derate(&mut self, factor: f32) {
        self.transfer.factor(factor);
    }

    /// Another verified model from the next sample on; ignored unless finite with a positive gain.
    pub fn retune(&mut self, model: Model) {
        if model.is_finite() && positive(model.b0) && positive(model.a1) {
            self.transfer.model(model);
        }
    }

    /// Goes over to other poles for the model in use at the next sample.
    pub(crate) const fn replace_poles(&mut self, poles: Poles, margins: Option<Margins>) {
        self.transfer.poles(poles, margins);
    }

    /// Whether other gains come into force with the next sample.
    pub(crate) const fn changes(&self) -> bool {
        self.transfer.has_arriving()
    }

    /// What a search for poles needs to know.
    pub(crate) const fn tuning_design(&self) -> &TuningDesign {
        &self.design.tuning
    }
}
