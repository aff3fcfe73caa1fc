//! A controller whose numbers can be worked out by hand.

use crate::servo::Config;
use crate::servo::control::controller::Controller;
use crate::servo::control::poles::Poles;
use crate::servo::model::Model;
use crate::servo::motion::Travel;

pub(in crate::servo::control) const POLES: Poles = Poles {
    bandwidth: 16.0,
    damping: 1.2,
    observer: 80.0,
    disturbance: 6.0,
};

/// A controller without a delay on a travel of 400; its window is 0.05, and what is quick takes
/// 1/300 s.
pub(in crate::servo::control) fn controller(model: Model) -> Controller {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let mut config = Config::new(1e-3, 25.0, travel);
    (config.delay, config.noise) = (0.0, Some(2e-4));
    config.controller.dead_volume = Some(f32::INFINITY);
    config.controller.rest_window = Some(0.05);
    let design = config.resolve().expect("settings");
    Controller::with_poles(&design.controller, model, POLES, None)
}
