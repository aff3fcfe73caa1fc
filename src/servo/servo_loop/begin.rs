//! The begin of a loop: in memory of its own, or in the place of another.

use crate::hardware::Axis;
use crate::servo::commissioning::{Commissioning, CommissioningDesign, Progress};
use crate::servo::config::Config;
use crate::servo::control::controller::Controller;
use crate::servo::control::limiter::CommandLimiter;
use crate::servo::design::Design;
use crate::servo::error::Error;
use crate::servo::identification::{expect_noise, identifier, replan, trends};
use crate::servo::model::Model;
use crate::servo::monitoring::{Monitors, stop::Stop};
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::followed::Followed;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::servo_loop::commands::Commands;
use crate::servo::servo_loop::drive::Drive;
use crate::servo::servo_loop::guard::Guard;
use crate::servo::servo_loop::learning::Learning;
use crate::servo::servo_loop::moves::{Gap, Moves};
use crate::servo::servo_loop::sensed::Sensed;
use crate::servo::servo_loop::takeover::{Fallback, Takeover};
use crate::servo::supervision::supervisor::Supervisor;

/// Both ways to begin from one list: what follows from settings, axis and design, of every field
/// but sensor, identifier, and the valve with what it was last told. A field that is missing here
/// does not compile.
macro_rules! fields {
    (of $config:ident, $axis:ident, $design:ident: $($field:ident: $value:expr,)*) => {
        impl<S, V> ServoLoop<S, V> {
            /// A loop in the state [`State::Idle`](crate::servo::State::Idle).
            ///
            /// # Errors
            /// An [`Error`] that names the setting.
            pub fn try_new($config: &Config, $axis: Axis, sensor: S, valve: V) -> Result<Self, Error> {
                let $design: &Design = &$config.resolve()?;
                let identifier = identifier(&$design.identification, $design.sample_time)?;
                let (limiter, commands) = (CommandLimiter::new(&$design.limiter), Commands::new());
                Ok(Self { sensor, valve, identifier, limiter, commands, $($field: $value,)* })
            }

            /// Begins anew with other settings, with the same sensor and valve: as
            /// [`ServoLoop::try_new`], in the place of this loop.
            ///
            /// Each part is made and put into its place before the next: the stack never holds a
            /// second loop, which has 11 kB. Not for the 1 ms path.
            ///
            /// The valve stays where it is: from its last command on it goes at the new rate, into
            /// the new range where it is outside of that, and to its middle.
            ///
            /// # Errors
            /// An [`Error`] that names the setting; the loop goes on as before.
            pub fn reconfigure(&mut self, $config: &Config, $axis: Axis) -> Result<(), Error> {
                let $design: &Design = &$config.resolve()?;
                let trends = trends(&$design.identification, $design.sample_time)?;
                replan(&mut self.identifier, &$design.identification, trends)?;
                expect_noise(&mut self.identifier, &$design.identification)?;
                self.identifier.reset();
                self.limiter.redesign(&$design.limiter);
                $(self.$field = $value;)*
                Ok(())
            }
        }
    };
}

fields! { of config, axis, design:
    axis: axis,
    config: config.clone(),
    supervisor: Supervisor::new(&design.supervision),
    controller: Controller::provisional(
        &design.controller.with_resolution(axis.resolution()),
        placeholder(config),
    ),
    commissioning: Commissioning::new(commissioning(config, &axis)),
    progress: Progress::Command(0.0),
    learning: Learning::new(design),
    drive: Drive {
        sign: if config.reversed == Some(true) { -1.0 } else { 1.0 },
        delay: config.delay,
        dead_volume: design.controller.estimator.dead_volume,
        imbalance: config.controller.imbalance,
        noise: config.noise.unwrap_or(0.0),
    },
    moves: Moves {
        trajectory: Trajectory::new(design.motion, design.travel, design.sample_time),
        followed: Followed::at(design.travel.min),
        run_out_rate: design.run_out_rate,
        tracking: AlphaBetaGamma::new(design.tracking_rate, design.sample_time),
        unsettled: 0,
        astray: 0.0,
        gap: Gap::default(),
    },
    sensed: Sensed::new(design.sensor_errors),
    guard: Guard {
        monitors: Monitors::new(
            &design.monitoring.with_resolution(axis.resolution()),
            &design.supervision.validation.observer,
            placeholder(config),
        ),
        alarm: None,
        stop: Stop::default(),
    },
    takeover: Takeover::default(),
    fallback: Fallback::new(None),
    start_requested: false,
}

/// What the commissioning needs to know of the settings.
fn commissioning(config: &Config, axis: &Axis) -> CommissioningDesign {
    CommissioningDesign {
        sample_time: config.sample_time,
        travel: config.travel,
        resolution: axis.resolution() / config.travel.length(),
        amplitude: config.excitation.amplitude,
        frequency: config.bandwidth,
        delay: config.delay,
        dead_volume: config.controller.dead_volume,
        excite_time: config.supervision.excite_time,
        time_limit: config.supervision.time_limit,
    }
}

/// A stable model for the controller until one is verified.
fn placeholder(config: &Config) -> Model {
    let square = config.rough_bandwidth() * config.rough_bandwidth();
    Model::linear(
        square,
        config.rough_bandwidth(),
        square * config.travel.length(),
    )
}
