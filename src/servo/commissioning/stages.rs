//! One sample of each stage, and what leads from one to the next.

use crate::servo::commissioning::defiance::{Shown, ValveClosing};
use crate::servo::commissioning::ends::at_end;
use crate::servo::commissioning::probe::{Probe, Probed};
use crate::servo::commissioning::relay::{Relay, Relayed};
use crate::servo::commissioning::standstill::{Standing, Standstill};
use crate::servo::commissioning::sweep::Sweep;
use crate::servo::commissioning::view::View;
use crate::servo::commissioning::{Commissioning, Progress, Stage, tracking_rate};
use crate::servo::supervision::state::Reason;

/// Points of the record per half period of the relay, and the largest spacing in s.
const POINTS_PER_HALF: f32 = 12.0;
const SPACING_MAX: f32 = 1e-2;
/// Least dead zone over the command at the first movement, for the levels.
const DEAD_ZONE_MIN: f32 = 0.4;
/// Time in s within which an axis beyond the safe travel comes back, and the least mean speed in
/// travels per s.
const RETURN_TIME: f32 = 0.25;
const RETURN_SPEED: f32 = 0.02;
/// Part of its mean speed in that time that an axis has at the end of it which does not brake.
const GOES_ON: f32 = 0.7;
/// Time in s from and to which the bounds of a model widen, and by how much.
const WIDENING: [f32; 3] = [1.8, 2.8, 1.6];

impl Commissioning {
    pub(crate) fn probe(&mut self, mut probe: Probe, y: f32, same_code: bool) -> Progress {
        let scale = 1.0_f32.min(2.0 * self.design.amplitude);
        match probe.update(y, same_code, &self.still, self.design.sample_time, scale) {
            Probed::Command(u) => {
                self.stage = Stage::Probing(probe);
                Progress::Command(u)
            }
            Probed::Moved { sign, command } => {
                let place = self.still.place;
                let detection = self.still.detection;
                // What a stop has held must go before anything moves: this command is too large.
                let winds = at_end(place) && probe.has_turned(scale);
                let tried = if winds { 0.0 } else { command };
                // What the stop bore no model has: its commands would count as closed ones. Here
                // the drive is what friction held.
                if winds {
                    self.record.restart(1);
                }
                let mut relay = self.relay_of(y, tried, sign);
                let v = self.tracking.motion().velocity;
                let first = relay.update(y, v, self.design.sample_time, self.design.amplitude);
                self.stage = Stage::Relaying(relay);
                self.standstill = Standstill::new(y, detection, command, y > place);
                self.moving_command = tried;
                match first {
                    Relayed::Command { command, .. } => Progress::Command(command),
                    _ => Progress::Command(0.0),
                }
            }
            Probed::SameCode => Progress::Failed(Reason::SensorStuck),
            Probed::Still => Progress::Failed(Reason::Blocked),
        }
    }

    pub(crate) fn relay(&mut self, mut relay: Relay, y: f32, v: f32) -> Progress {
        match relay.update(y, v, self.design.sample_time, self.design.amplitude) {
            Relayed::Command { command, sign } => {
                if sign != self.sign {
                    self.standstill.mistook(command.abs());
                }
                self.sign = sign;
                self.stage = Stage::Relaying(relay);
                Progress::Command(command)
            }
            Relayed::Obeys { half, sign } => {
                if let Some(known) = self.known_sign.filter(|known| *known != sign) {
                    return self.doubt(relay, known, y, v);
                }
                self.sign = sign;
                if self.moving_command == 0.0 {
                    self.moving_command = relay.moving();
                }
                self.begin_search(half, y)
            }
            // What stands is not moved by a valve that is open.
            Relayed::Disobeys if v.abs() < RETURN_SPEED && !at_end(y) => {
                Progress::Failed(Reason::Blocked)
            }
            Relayed::Disobeys => Progress::Failed(Reason::ValveStuck),
        }
    }

    /// The axis seems to obey the other sign than the one that is known. What still swings from a
    /// motion before does, too, while the valve has not left its dead zone: a relay of the known
    /// sign decides, with larger commands. The other sign makes that one run away.
    fn doubt(&mut self, before: Relay, known: f32, y: f32, v: f32) -> Progress {
        if core::mem::replace(&mut self.suspicion.mirrored, true) {
            return Progress::Failed(Reason::WrongSign);
        }
        self.relay(self.relay_of(y, before.largest(), known), y, v)
    }

    /// A relay about the rest, of an axis that a command with this sign has moved to `y`.
    fn relay_of(&self, y: f32, command: f32, sign: f32) -> Relay {
        let place = self.still.place;
        let hysteresis = Relay::hysteresis(&self.still, &self.tracking);
        let side = if y > place { 1.0 } else { -1.0 };
        Relay::new(place, hysteresis, command, sign, side)
    }

    fn begin_search(&mut self, half: f32, y: f32) -> Progress {
        let step = self.design.sample_time;
        let frequency = self
            .design
            .frequency
            .unwrap_or(core::f32::consts::PI / half);
        let half = core::f32::consts::PI / frequency;
        let spacing = SPACING_MAX.min(half / POINTS_PER_HALF);
        let dead_zone = (0.5 * self.moving_command).min(0.1);
        self.first_guess = Some([spacing / step, frequency, dead_zone]);
        self.tracking.retune(tracking_rate(frequency, step));
        self.standstill
            .inform(half, self.tracking.acceleration_noise());
        let hold = half.min(0.25);
        let mut sweep = Sweep::new(y, hold, dead_zone, self.design.amplitude, self.attempt);
        sweep.pushes([true, false].map(|up| self.standstill.push(up)));
        self.stage = Stage::Sweeping(sweep);
        self.informed = 0.0;
        Progress::Command(0.0)
    }

    /// Gives the record its spacing, a doubling per sample, and begins the search.
    fn settle_record(&mut self) {
        let Some([stride, frequency, dead_zone]) = self.first_guess else {
            return;
        };
        if !self.record.fix(stride as usize) {
            return;
        }
        self.first_guess = None;
        let time = self.record.stride() as f32 * self.design.sample_time;
        let view = View::of(time, self.still.sigma, self.sign);
        let points = self.record.end() + (self.design.excite_time / time) as usize;
        self.search
            .begin(points, view, self.still.sigma, [frequency, dead_zone]);
    }

    pub(crate) fn sweep(&mut self, mut sweep: Sweep, y: f32, v: f32) -> Progress {
        if sweep.is_safe(y) {
            self.outside.time = 0.0;
        } else if let Some(progress) = self.stay_outside(y, v, sweep.half()) {
            return progress;
        }
        let [from, to, most] = WIDENING;
        let share = ((self.time - from) / (to - from)).clamp(0.0, 1.0);
        let slack = 1.0 + share * (most - 1.0);
        self.settle_record();
        self.has_rested = self.accepted.is_some();
        if self.accepted.is_none() && !self.suspicion.defied {
            self.accepted = self.search.update(&self.record, slack);
        }
        if let Some(theta) = self.search.latest()
            && theta.a1 != self.informed
        {
            self.informed = theta.a1;
            let half = 2.6 / crate::math::sqrt(theta.a1);
            let least = DEAD_ZONE_MIN * self.moving_command.min(0.25);
            sweep.inform(half.min(0.35), theta.dead_zone.max(least), theta.offset);
        }
        let acceleration = self.tracking.motion().acceleration;
        let command = sweep.update(y, v, acceleration, self.design.sample_time);
        self.stage = Stage::Sweeping(sweep);
        match self.accepted {
            // The axis moves on until the loop is ready for it.
            Some(theta) => Progress::Found(self.found(&theta), self.sign * command),
            None => Progress::Command(self.sign * command),
        }
    }

    /// A sample beyond the safe travel: the command leads inwards, and the axis has to follow.
    fn stay_outside(&mut self, y: f32, v: f32, half: f32) -> Option<Progress> {
        let outside = &mut self.outside;
        let inward = if y < 0.5 { 1.0 } else { -1.0 };
        let returned = inward * (y - outside.outermost);
        if outside.time == 0.0 || returned > RETURN_TIME * RETURN_SPEED {
            (outside.time, outside.began, outside.outermost) = (0.0, y, y);
        } else if returned < 0.0 {
            outside.outermost = y;
        }
        outside.time += self.design.sample_time;
        if !(outside.time > RETURN_TIME) {
            return None;
        }
        let mean = inward * (outside.began - y) / RETURN_TIME;
        if mean > RETURN_SPEED && -inward * v > GOES_ON * mean {
            self.suspicion.closing = Some(ValveClosing::new(-inward * mean, half));
            return Some(Progress::Command(0.0));
        }
        // What stands is pushed until it moves, or nothing moves it.
        outside.time = 0.0;
        (mean > RETURN_SPEED && !at_end(y)).then_some(Progress::Failed(Reason::TravelEnd))
    }

    /// What the position of an axis that stays means under its command.
    pub(crate) fn watch_standstill(
        &mut self,
        y: f32,
        same_code: bool,
        progress: &Progress,
    ) -> Standing {
        let command = match progress {
            Progress::Command(command) | Progress::Found(_, command) => self.sign * command,
            Progress::Failed(_) => 0.0,
        };
        let step = self.design.sample_time;
        self.standstill
            .update(y, same_code, command, step, self.search.latest())
    }

    /// The valve is closed until it is known why the axis moves. Of one that meets an end of the
    /// travel meanwhile the levels show why: they press it on the stop, then the other way. A wrong
    /// sign takes it off the stop, and a spool that is stuck moves it neither way.
    pub(crate) fn close(&mut self, mut closing: ValveClosing, y: f32, v: f32) -> Progress {
        let shown = closing.update(y, v, self.design.sample_time);
        self.suspicion.closing = Some(closing);
        match shown {
            None => Progress::Command(0.0),
            Some(Shown::Why(reason)) => Progress::Failed(reason),
            Some(Shown::Nothing) => {
                (self.suspicion.closing, self.suspicion.defied) = (None, true);
                self.standstill.strike(y);
                Progress::Command(0.0)
            }
            Some(Shown::Stops) => {
                self.suspicion.closing = None;
                self.standstill.resume(y);
                if let Stage::Sweeping(sweep) = &mut self.stage {
                    sweep.prove();
                }
                Progress::Command(0.0)
            }
        }
    }

    /// The progress, unless the axis moves against its commands: the valve is closed to see why.
    ///
    /// Where a swing of another time scale explains it, the axis is stopped, and driven on the same
    /// way from there. One that has gone out of reach of a swing from there as well does not swing.
    pub(crate) fn unless_defiant(&mut self, progress: Progress) -> Progress {
        let (Stage::Sweeping(sweep), Progress::Command(command)) = (&self.stage, progress) else {
            return progress;
        };
        let (half, step) = (sweep.half(), self.design.sample_time);
        let motion = self.tracking.motion();
        let doubtful = self
            .standstill
            .is_out_of_reach(&motion, self.sign * command, step);
        let proven = sweep.proves() && self.standstill.is_driven();
        let (velocity, surely) = match self.standstill.defies() {
            Some(velocity) => (velocity, true),
            None if doubtful => (motion.velocity, proven),
            None => return progress,
        };
        self.suspicion.closing = Some(if surely {
            ValveClosing::new(velocity, half)
        } else {
            ValveClosing::in_doubt(velocity, half)
        });
        Progress::Command(0.0)
    }

    /// The progress, unless an axis stays that must move.
    pub(crate) const fn unless_unresponsive(
        &self,
        standing: Standing,
        progress: Progress,
    ) -> Progress {
        match standing {
            Standing::Unresponsive if self.suspicion.defied => Progress::Failed(Reason::ValveStuck),
            Standing::Unresponsive if self.standstill.code_changes() => {
                Progress::Failed(Reason::Blocked)
            }
            Standing::Unresponsive => Progress::Failed(Reason::SensorStuck),
            _ => progress,
        }
    }
}

#[cfg(test)]
mod tests;
