//! From what the commissioning found to a loop that controls.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::commissioning::Found;
use crate::servo::config::Config;
use crate::servo::control::controller::Controller;
use crate::servo::design::constants as c;
use crate::servo::error::Error;
use crate::servo::identification::identifier;
use crate::servo::model::Model;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::store::Record;
use crate::servo::supervision::excitation_monitor::ExcitationMonitor;
use crate::servo::supervision::state::Reason;

/// The settings with what was found in the place of what was stated.
fn tuned(config: &Config, found: &Found) -> Config {
    let w = c::ROUGH_RATIO * crate::math::sqrt(found.model.a1);
    let time = config.sample_time;
    let mut tuned = config.clone();
    tuned.bandwidth = Some(w);
    tuned.delay = found.delay.min(c::DELAY_MAX as f32 * time);
    tuned.noise = Some(config.noise.unwrap_or(found.noise));
    // What the noise must not reach.
    let length = config.travel.length();
    let least = |ratio: f32| {
        // A little more noise than usual is within the windows.
        let scaled = 0.75 * ratio / c::NOISE_RATIO * found.noise;
        let usual = ratio * length;
        Some(if scaled > usual { scaled } else { usual })
    };
    let controller = &mut tuned.controller;
    controller.rest_window = controller.rest_window.or(least(c::REST_WINDOW_RATIO));
    controller.breakaway_distance = controller
        .breakaway_distance
        .or(least(c::BREAKAWAY_DISTANCE_RATIO));
    if config.controller.bandwidth.is_none() {
        let mut wanted = c::CONTROLLER_RATIO * w;
        for most in [c::DELAY_STEP_MAX / found.delay, c::TUNED_STEP_MAX / time] {
            if most < wanted {
                wanted = most;
            }
        }
        tuned.controller.bandwidth = Some(wanted);
    }
    tuned
}

impl<S, V> ServoLoop<S, V> {
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
        self.controller = Controller::new(&design, model);
        self.trajectory = Trajectory::new(design.motion, design.travel, design.sample_time);
        self.trajectory.hold(self.commissioning.motion().position);
        self.monitor = ExcitationMonitor::new(&design.monitor);
        self.supervisor.redesign(&design.supervision);
        let resolution = self.axis.scale.units(1).abs();
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
