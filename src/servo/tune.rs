//! From what the commissioning found to a loop that controls.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::building::tuned;
use crate::servo::commissioning::Found;
use crate::servo::control::tuning::Tuned;
use crate::servo::design::{Clock, TuningDesign};
use crate::servo::error::Error;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::store::Record;
use crate::servo::supervision::event::Spare;
use crate::servo::supervision::state::Reason;

/// Pieces per sample of the search for poles while the commissioning computes nothing else.
pub(crate) const PIECES_PER_SAMPLE: u32 = 6;
/// The same in control, while no models are compared and while they are.
const PIECES_IN_CONTROL: [u32; 2] = [2, 1];

impl<S, V> ServoLoop<S, V> {
    /// Whether the search for what was found has poles.
    pub(crate) fn has_poles(&self, found: &Found) -> bool {
        let tuned = self.takeover.tuning.as_ref();
        tuned.is_some_and(|t| t.model == found.model && (t.done || t.tuning.has_some()))
    }

    /// `pieces` of the search for what was found, until there are poles. Begins again for another
    /// model.
    pub(crate) fn search_poles(&mut self, found: &Found, pieces: u32) {
        if self
            .takeover
            .tuning
            .as_ref()
            .is_none_or(|t| t.model != found.model)
        {
            let time = self.config.sample_time;
            let settings = &self.config.controller;
            let clock = Clock { sample_time: time };
            let design = TuningDesign {
                sample_time: time,
                delay: clock.delay(found.delay) as f32 * time,
                dead_volume: found.dead_volume,
                noise: self.config.noise_beside(found.noise),
                bandwidth_max: settings.bandwidth.unwrap_or(f32::INFINITY),
            };
            self.takeover.tuning = Some(Tuned::new(&design, found.model));
            return;
        }
        let Some(tuned) = &mut self.takeover.tuning else {
            return;
        };
        for _ in 0..pieces {
            if tuned.done || tuned.tuning.has_some() {
                return;
            }
            let begins = tuned.tuning.begins();
            tuned.done = tuned.tuning.step();
            if begins {
                break;
            }
        }
    }

    /// What the sample to come has time for.
    pub(crate) fn spare(&self) -> Spare {
        if !self.supervisor.state().is_controlling() {
            Spare::Thought
        } else if self.moves.trajectory.is_planning() {
            Spare::Nothing
        } else if self.supervisor.steps() || self.controller.changes() {
            Spare::Step
        } else {
            Spare::Thought
        }
    }

    /// Some pieces more of a search that goes on in control; faster poles that it finds come into
    /// force in a sample of their own. A newer model restarts it: until it ends, the poles in use
    /// follow the model by its natural frequency, which keeps their margins.
    pub(crate) fn refine_poles(&mut self) {
        if let Some(model) = self.takeover.unsearched.take() {
            let design = self.controller.tuning_design();
            self.takeover.tuning = Some(Tuned::new(design, model));
            return;
        }
        let Some(tuned) = &mut self.takeover.tuning else {
            return;
        };
        if !tuned.done {
            let [alone, beside] = PIECES_IN_CONTROL;
            let pieces = match self.supervisor.comparison.rests() {
                true => alone,
                false => beside,
            };
            tuned.done = (0..pieces).any(|_| tuned.tuning.step());
            return;
        }
        let (poles, margins) = tuned.tuning.poles();
        if self.supervisor.verified_model() == Some(tuned.model) {
            self.controller.replace_poles(poles, margins);
        }
        self.takeover.tuning = None;
    }

    /// Control from the next sample on with what an earlier commissioning found, in the motion that
    /// the axis then has, as [`install`](Self::install).
    ///
    /// # Errors
    /// [`Error::Model`] with the reason, when the model does not pass what every candidate must,
    /// when delay or noise are negative or not finite, or when the sign is not that of the
    /// settings; [`Error::Setting`] for the place of the axis, as [`install`](Self::install). The
    /// loop is as before.
    pub fn resume(&mut self, record: &Record) -> Result<(), Error>
    where
        S: PositionSensor,
        V: Valve,
    {
        self.may_take_over()?;
        let Record {
            model,
            std: [a1, a2, b0, ..],
            delay,
            sign,
            noise,
            dead_volume,
            imbalance,
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
            dead_volume,
            imbalance,
        };
        let design = tuned(&self.config, &found).resolve()?;
        design
            .supervision
            .screening
            .admits(&model)
            .map_err(Error::Model)?;
        // The observer that knows it is replaced.
        let motion = self.present_motion(&model, self.config.noise_beside(noise));
        let before = self.takeover.building.take();
        loop {
            match self.build(&found) {
                Ok(true) => break,
                Ok(false) => {}
                Err(reason) => {
                    self.takeover.building = before;
                    return Err(Error::Model(reason));
                }
            }
        }
        self.install_in(model, motion)?;
        self.supervisor.recall([a1, a2, b0]);
        Ok(())
    }

    /// The verified model and its conditions, for [`resume`](Self::resume) after a loss of power;
    /// `None` before there is one.
    pub fn record(&self) -> Option<Record> {
        let model = self.supervisor.verified_model()?;
        let [a1, a2, b0] = self.supervisor.verified_std();
        Some(Record {
            model,
            std: [a1, a2, b0, f32::INFINITY, f32::INFINITY, f32::INFINITY],
            delay: self.drive.delay,
            sign: self.drive.sign,
            noise: self.drive.noise,
            dead_volume: self.drive.dead_volume,
            imbalance: self.drive.imbalance,
        })
    }
}
