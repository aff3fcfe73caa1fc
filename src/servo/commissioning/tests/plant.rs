//! The drive of the tests: its own model, behind a valve and a sensor that break.

use crate::servo::model::Model;
use crate::servo::motion::{Motion, Travel};

pub(super) const STEP: f32 = 1e-3;

/// Units per count, and the travel.
pub(super) const COUNT: f32 = 1e-3;
pub(super) const TRAVEL: Travel = Travel {
    min: 100.0,
    max: 500.0,
};

/// A drive behind a valve of either sign, with a delay in samples.
#[derive(Clone)]
pub(super) struct Plant {
    model: Model,
    pub(super) sign: f32,
    commands: [f32; 8],
    delay: usize,
    pub(super) motion: Motion,
    /// What stands in the way, and a sensor that says nothing new.
    pub(super) walls: [f32; 2],
    pub(super) is_deaf: bool,
    /// The hardest blow to what stands in the way.
    pub(super) blow: f32,
    /// The command at which the spool sticks.
    pub(super) stuck: Option<f32>,
    state: u32,
    code: i32,
}

impl Plant {
    pub(super) fn new(model: Model, sign: f32, delay: usize) -> Self {
        Self {
            model,
            sign,
            commands: [0.0; 8],
            delay,
            motion: Motion::at(280.0),
            walls: [TRAVEL.min, TRAVEL.max],
            is_deaf: false,
            blow: 0.0,
            stuck: None,
            state: 1,
            code: 0,
        }
    }

    /// The position as it is measured, and whether its code is the one before.
    pub(super) fn read(&mut self) -> (f32, bool) {
        self.state = (self.state.wrapping_mul(1_664_525)).wrapping_add(1_013_904_223);
        let noise = (self.state >> 8) as f32 / 8_388_608.0 - 1.0;
        let code = libm::roundf((self.motion.position + 2e-3 * noise) / COUNT) as i32;
        let code = if self.is_deaf { 280_000 } else { code };
        let same = code == self.code;
        self.code = code;
        (code as f32 * COUNT, same)
    }

    pub(super) fn step(&mut self, command: f32) {
        self.commands.rotate_right(1);
        self.commands[0] = self.stuck.unwrap_or(command);
        let flow = self.model.valve_flow(self.sign * self.commands[self.delay]);
        let before = self.motion.position;
        self.model.advance(&mut self.motion, flow, STEP);
        let [low, high] = self.walls;
        let inside = before > low && before < high;
        if self.motion.position < low || self.motion.position > high {
            if inside {
                self.blow = self.blow.max(self.motion.velocity.abs());
            }
            self.motion = Motion::at(self.motion.position.clamp(low, high));
        }
    }
}
