//! From what the commissioning found to a loop that controls.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::commissioning::Found;
use crate::servo::config::Config;
use crate::servo::control::controller::Controller;
use crate::servo::control::tuning::{Tuned, Tuning};
use crate::servo::design::TuningDesign;
use crate::servo::design::constants as c;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::error::Error;
use crate::servo::identification::identifier;
use crate::servo::model::Model;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::store::Record;
use crate::servo::supervision::excitation_monitor::ExcitationMonitor;
use crate::servo::supervision::state::Reason;

/// Frequencies per sample of the search for poles.
const FREQUENCIES_PER_SAMPLE: u32 = 3;

/// The settings with what was found in the place of what was stated.
fn tuned(config: &Config, found: &Found) -> Config {
    let w = c::ROUGH_RATIO * crate::math::sqrt(found.model.a1);
    let mut tuned = config.clone();
    tuned.bandwidth = Some(w);
    tuned.delay = found.delay.min(DELAY_MAX as f32 * config.sample_time);
    tuned.noise = Some(config.noise.unwrap_or(found.noise));
    tuned
}

impl<S, V> ServoLoop<S, V> {
    /// The newest command, for the controller that takes over.
    #[inline]
    pub(crate) fn remember(&mut self, command: f32) {
        self.newest += 1;
        if self.newest >= self.commands.len() {
            self.newest = 0;
        }
        if let Some(slot) = self.commands.get_mut(self.newest) {
            *slot = command;
        }
    }

    /// A few frequencies of the search for what was found; whether there are poles. Begins again for another model.
    pub(crate) fn search_poles(&mut self, found: &Found) -> bool {
        if self.tuning.as_ref().is_none_or(|t| t.model != found.model) {
            let time = self.config.sample_time;
            let settings = &self.config.controller;
            let samples = (found.delay / time + 0.5) as usize;
            let design = TuningDesign {
                sample_time: time,
                delay: samples.min(DELAY_MAX) as f32 * time,
                dead_volume: settings.dead_volume,
                noise: self.config.noise.unwrap_or(found.noise),
                bandwidth_max: settings.bandwidth.unwrap_or(f32::INFINITY),
            };
            self.tuning = Some(Tuned {
                model: found.model,
                tuning: Tuning::new(&design, &found.model),
                done: false,
            });
            return false;
        }
        let Some(tuned) = &mut self.tuning else {
            return false;
        };
        for _ in 0..FREQUENCIES_PER_SAMPLE {
            tuned.done = tuned.done || tuned.tuning.step();
        }
        tuned.done || tuned.tuning.has_some()
    }

    /// One frequency more of a search that goes on in control; faster poles that it finds come into force.
    pub(crate) fn refine_poles(&mut self) {
        let Some(tuned) = &mut self.tuning else {
            return;
        };
        if !tuned.tuning.step() {
            return;
        }
        let (poles, margins) = tuned.tuning.poles();
        if self.supervisor.verified_model() == Some(tuned.model) {
            self.controller.replace_poles(poles, margins);
        }
        self.tuning = None;
    }

    /// Searches the poles for another model from now on.
    pub(crate) fn search_again(&mut self, model: Model) {
        self.tuning = Some(Tuned {
            model,
            tuning: Tuning::new(self.controller.tuning_design(), &model),
            done: false,
        });
    }

    /// Builds identifier, controller and supervision for the axis that was found.
    ///
    /// Cost: see the table of instruction counts.
    pub(crate) fn tune(&mut self, found: &Found) -> Result<(), Reason> {
        self.rebuild(&tuned(&self.config, found), found.model)
            .map_err(|_| Reason::OutOfRange)?;
        self.sign = found.sign;
        self.delay = found.delay;
        self.noise = found.noise;
        Ok(())
    }

    /// Control from the next sample on with what an earlier commissioning found, at the actual position.
    ///
    /// # Errors
    /// [`Error::Model`] with the reason, when the model does not pass what every candidate must, when delay or noise are
    /// negative or not finite, or when the sign is not that of the settings; the loop is as before.
    pub fn resume(&mut self, record: &Record) -> Result<(), Error>
    where
        S: PositionSensor,
        V: Valve,
    {
        let Record {
            model,
            delay,
            sign,
            noise,
            ..
        } = *record;
        let stated = self
            .config
            .reversed
            .map(|reversed| if reversed { -1.0 } else { 1.0 });
        if !(sign == 1.0 || sign == -1.0) || stated.is_some_and(|stated| stated != sign) {
            return Err(Error::Model(Reason::WrongSign));
        }
        let fits = |number: f32| number >= 0.0 && number.is_finite();
        if !(model.is_finite() && fits(delay) && fits(noise)) {
            return Err(Error::Model(Reason::NotFinite));
        }
        if !(model.a1 > 0.0) {
            return Err(Error::Model(Reason::Unstable));
        }
        let found = Found {
            model,
            delay,
            sign,
            noise,
        };
        let design = tuned(&self.config, &found).resolve()?;
        design
            .supervision
            .screening
            .admits(&model)
            .map_err(Error::Model)?;
        self.tune(&found).map_err(Error::Model)?;
        self.install(model)
    }

    /// The verified model and its conditions, for [`resume`](Self::resume) after a loss of power; `None` before there is one.
    pub fn record(&self) -> Option<Record> {
        let model = self.supervisor.verified_model()?;
        Some(Record {
            model,
            std: [f32::INFINITY; 6],
            delay: self.delay,
            sign: self.sign,
            noise: self.noise,
        })
    }

    fn rebuild(&mut self, config: &Config, model: Model) -> Result<(), Error> {
        let design = config.resolve()?;
        let identifier = identifier(&design.identification, design.sample_time)?;
        self.identifier = identifier;
        self.run_out_rate = design.run_out_rate;
        self.settled = design.identification.settled;
        let resolution = self.axis.scale.units(1).abs();
        let controller = design.controller.with_resolution(resolution);
        self.controller = match &self.tuning {
            Some(tuned) if tuned.model == model => {
                let (poles, margins) = tuned.tuning.poles();
                Controller::with_poles(&controller, model, poles, margins)
            }
            // The poles are searched where the model is installed.
            _ => Controller::provisional(&controller, model),
        };
        self.trajectory = Trajectory::new(design.motion, design.travel, design.sample_time);
        self.trajectory.hold(self.commissioning.motion().position);
        self.monitor = ExcitationMonitor::new(&design.monitor);
        self.supervisor.redesign(&design.supervision);
        self.monitors.redesign(
            &design.monitoring.with_resolution(resolution),
            &design.supervision.validation.observer,
            model,
        );
        self.tracking = AlphaBetaGamma::new(design.tracking_rate, design.sample_time);
        self.tracking.begin(self.commissioning.motion());
        Ok(())
    }
}
