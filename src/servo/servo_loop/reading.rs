//! The position of a sample: measured, expected, or missing; and the first one.
//!
//! What is expected goes into the filter of the measured positions, and must not make it diverge.
//! In control it comes from the observer of the controller: the filter stays a stable filter of
//! bounded positions. The observer itself is corrected once for a gap, by the gains of one sample:
//! with its poles at 0.3 per sample at most it bears every other sample missing, and more end in
//! [`Reason::SensorFault`]. Outside of control, and in control that still awaits the motion, the
//! filter expects by itself. Its poles are up to a half per sample, with which the gains of one
//! sample diverge over two: behind a gap it begins again by the reading and the one before the gap,
//! and nothing of what it expected is left.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::monitoring::reading::Credibility;
use crate::servo::motion::{Motion, Setpoint};
use crate::servo::report::Report;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::supervision::state::Reason;

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// The position of a sample: measured, or expected where the reading failed or cannot be true;
    /// `None` without either. `missed`: failed readings in a row before this one.
    pub(super) fn reading(&mut self, code: Option<i32>, missed: u32) -> Option<f32> {
        let bridges = self.sensed.begun && !self.sensed.is_lost();
        let Some(code) = code else {
            let missing = self.guard.monitors.count_reading(true, true);
            if missing && self.is_active() {
                self.fail(Reason::SensorFault);
            }
            return bridges.then(|| self.expected());
        };
        let y = self.axis.position(code);
        if !(self.sensed.begun && self.is_active()) {
            // Whether readings fail again and again is known when a commissioning begins.
            let _ = self.guard.monitors.count_reading(false, false);
            self.moves.look(y, self.config.sample_time);
            return Some(self.measured(y, missed));
        }
        let verdict = self
            .guard
            .monitors
            .classify(y, &self.moves.tracking.motion(), missed);
        if self
            .guard
            .monitors
            .count_reading(false, verdict != Credibility::Good)
        {
            self.fail(Reason::SensorFault);
        }
        match verdict {
            Credibility::Good => Some(self.measured(y, missed)),
            Credibility::Bridge => Some(self.expected()),
            Credibility::Lasting(reason) => {
                self.fail(reason);
                Some(self.expected())
            }
        }
    }

    /// Whether the loop moves the axis.
    pub(super) fn is_active(&self) -> bool {
        let state = self.supervisor.state();
        state.is_commissioning() || state.is_controlling() && !self.awaits_motion()
    }

    /// The first sample, and the first one of a commissioning.
    pub(super) fn begin(&mut self, y: f32) {
        if !self.sensed.begun {
            self.sensed.begun = true;
            self.moves.begin_again(y, self.config.sample_time);
            self.moves.trajectory.stand(y, self.moves.run_out_rate);
            self.moves
                .follow(self.controller.delay(), self.config.sample_time);
            self.controller.place(Motion::at(y));
            self.guard
                .monitors
                .place(Motion::at(y), self.limiter.last());
            // Control was asked for before anybody knew where the axis is.
            if self.supervisor.state().is_controlling()
                && !self.start_requested
                && self.config.travel.admits(y).is_err()
            {
                self.fail(Reason::Implausible);
            }
        }
        if self.start_requested && !self.comes_to_rest() {
            self.start_requested = false;
            self.guard.release();
            self.supervisor.begin();
            self.takeover.watching = 0;
            self.stop_building();
            let known =
                self.config.reversed.is_some() || self.supervisor.verified_model().is_some();
            self.commissioning
                .begin(y, known.then_some(self.drive.sign));
        }
    }

    /// The motion as far as it is known: by the observer in control, else by the measured positions
    /// alone.
    pub(crate) fn motion(&self) -> Motion {
        if self.supervisor.state().is_controlling() {
            self.controller.motion()
        } else {
            self.moves.tracking.motion()
        }
    }

    /// A reading that counts; behind a gap outside of control the measured motion begins with it.
    #[inline]
    fn measured(&mut self, y: f32, missed: u32) -> f32 {
        if self.moves.gap.is_open() || missed > 0 {
            self.rejoin(y, missed);
        }
        y
    }

    /// The measured motion behind a gap: the mean speed over it; at rest where it was longer than
    /// what is bridged, as then nothing is known of the motion.
    fn rejoin(&mut self, y: f32, missed: u32) {
        let mean = self.moves.gap.end(y);
        if self.observes() {
            return;
        }
        let known = missed < self.sensed.errors_max;
        let step = mean.filter(|_| known).unwrap_or(0.0);
        // A sample ago: the filter then takes the reading itself.
        self.moves.tracking.begin(Motion {
            position: y - step,
            velocity: step / self.config.sample_time,
            acceleration: 0.0,
        });
        if !known {
            self.moves.unsettle(self.config.sample_time);
        }
    }

    /// Predicted position, which replaces a failed reading.
    pub(super) fn expected(&mut self) -> f32 {
        let (m, before) = if self.observes() {
            (self.controller.motion(), None)
        } else {
            (self.moves.tracking.motion(), Some(self.sensed.position))
        };
        self.moves.gap.grow(before);
        m.after(self.config.sample_time)
    }

    /// A sample without a measured or predicted position: the valve goes to zero.
    pub(super) fn blind(&mut self) -> Report {
        if self.sensed.is_lost() {
            self.fail(Reason::SensorFault);
        }
        self.guard.stop.end();
        let command = self.command_valve(self.centre()).unwrap_or(0.0);
        self.identifier.restart_trends();
        self.report(Setpoint::at(self.sensed.position), command, None, false)
    }
}
