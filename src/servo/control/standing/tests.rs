//! Axes without friction at a target, with dead zones, forces and leaks that their model does not
//! know.

use super::*;
use crate::servo::Travel;
use crate::servo::config::Config;
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Setpoint};

const WINDOW: f32 = 0.2;
const MODEL: Model = Model {
    dead_zone: 0.05,
    ..Model::linear(900.0, 20.0, 9.0e5)
};

/// A controller at its target, and the axis that it sees.
struct Stand {
    controller: Controller,
    drive: Model,
    leak: f32,
    motion: Motion,
}

/// What the axis did in a time.
#[derive(Debug, Default, PartialEq)]
struct Seen {
    worst: f32,
    /// Samples behind a closed valve, and how often the axis left that rest.
    closed: usize,
    left: usize,
    /// Range of the command.
    commands: [f32; 2],
}

impl Stand {
    fn new(model: Model, drive: Model, leak: f32) -> Self {
        let travel = Travel {
            min: -200.0,
            max: 200.0,
        };
        let mut config = Config::new(0.001, 20.0, travel);
        config.delay = 0.003;
        config.controller.dead_volume = Some(f32::INFINITY);
        config.controller.rest_window = Some(WINDOW);
        let design = config.resolve().expect("settings");
        Self {
            controller: Controller::new(&design, model),
            drive,
            leak,
            motion: Motion::default(),
        }
    }

    /// Samples at a target, measured to 0.02.
    fn hold(&mut self, target: f32, samples: usize) -> Seen {
        let mut seen = Seen {
            commands: [f32::INFINITY, f32::NEG_INFINITY],
            ..Seen::default()
        };
        let mut on_the_way = [0.0; 3];
        for _ in 0..samples {
            let y = 0.02 * libm::rintf(self.motion.position / 0.02);
            let before = self.controller.rest.rests();
            let u = self.controller.update(&Setpoint::at(target), y);
            let u = u.clamp(-1.0, 1.0);
            self.controller.applied(u);
            on_the_way.rotate_left(1);
            let late = core::mem::replace(&mut on_the_way[2], u);
            let flow = self.drive.valve_flow(late) + self.leak;
            self.drive.advance(&mut self.motion, flow, 0.001);
            let error = (target - self.motion.position).abs();
            seen.worst = seen.worst.max(error);
            seen.closed += usize::from(self.controller.rest.rests());
            seen.left += usize::from(before && !self.controller.rest.rests());
            seen.commands = [seen.commands[0].min(u), seen.commands[1].max(u)];
        }
        seen
    }
}

#[test]
fn an_axis_that_nothing_holds_stands_behind_a_closed_valve() {
    for dead_zone in [0.035, 0.045, 0.05, 0.055, 0.065] {
        let drive = Model { dead_zone, ..MODEL };
        let mut stand = Stand::new(MODEL, drive, 0.0);
        for target in [10.0, 10.3, -20.0] {
            let _ = stand.hold(target, 3000);
            let seen = stand.hold(target, 1000);
            let [least, most] = seen.commands;
            let lead = stand.controller.rest.lead(2.6 * WINDOW);
            assert!(most - least <= lead, "{dead_zone} to {target}: {seen:?}");
            let flows = [least, most].map(|u| drive.valve_flow(u));
            assert_eq!(flows, [0.0; 2], "{dead_zone} to {target}: {seen:?}");
            assert_eq!((seen.closed, seen.left), (1000, 0), "{dead_zone}");
            assert!(
                seen.worst < 1.3 * WINDOW,
                "{dead_zone} to {target}: {seen:?}"
            );
        }
    }
}

#[test]
fn a_valve_that_would_not_hold_the_axis_stays_open() {
    // A spool that is off by more than what may not be known of its dead zone.
    let model = Model {
        dead_zone: 0.02,
        ..MODEL
    };
    let drive = Model {
        offset: 0.045,
        ..model
    };
    let mut stand = Stand::new(model, drive, 0.0);
    let _ = stand.hold(10.0, 4000);
    let seen = stand.hold(10.0, 2000);
    assert_eq!(seen.closed, 0, "{seen:?}");
    assert!(seen.worst < 1.3 * WINDOW, "{seen:?}");
}

#[test]
fn a_valve_closes_elsewhere_where_a_leak_moves_the_axis_from_its_rest() {
    for leak in [-0.008_f32, 0.004, 0.008] {
        let model = Model {
            dead_zone: 0.01,
            ..MODEL
        };
        let mut stand = Stand::new(model, model, leak);
        let first = stand.hold(10.0, 5000);
        let _ = stand.hold(10.0, 15_000);
        let last = stand.hold(10.0, 5000);
        assert!(first.left > 3, "{leak}: {first:?} {last:?}");
        assert!(
            last.left == 0 && last.worst < 1.3 * WINDOW,
            "{leak}: {first:?} {last:?}"
        );
        let command = stand.controller.holding.command();
        assert!(
            command.is_some_and(|c| c * leak < 0.0),
            "{leak}: {command:?}"
        );
    }
}

#[test]
fn a_valve_at_rest_leads_an_axis_stably_whatever_its_delay_and_with_three_times_its_mass() {
    for frequency in [5.0_f32, 30.0, 150.0] {
        for damping in [0.02_f32, 0.1, 0.3, 1.0, 2.0] {
            let model = Model::linear(frequency * frequency, 2.0 * damping * frequency, 1e4);
            let rate = lead(&model, frequency) * model.b0 / model.a1;
            for mass in [1.0_f32, 3.0] {
                let (a1, a2) = (model.a1 / mass, model.a2 / mass);
                // |L| and its phase behind a delay of ten times 1/w0, by the frequency.
                let open = |w: f32| {
                    let (re, im) = (a1 - w * w, a2 * w);
                    let size = rate * a1 / (w * libm::hypotf(re, im));
                    let phase = core::f32::consts::FRAC_PI_2 + libm::atan2f(im, re);
                    (size, phase + 10.0 * w / frequency)
                };
                let mut crossed = false;
                for k in 1..4000 {
                    let w = 1e-3 * k as f32 * frequency;
                    let (size, phase) = open(w);
                    crossed |= size < 1.0;
                    if crossed {
                        assert!(size < 1.0, "{frequency} {damping} {mass} at {w}: {size}");
                    } else {
                        assert!(phase < 3.0, "{frequency} {damping} {mass} at {w}: {phase}");
                    }
                }
                assert!(crossed);
            }
        }
    }
}
