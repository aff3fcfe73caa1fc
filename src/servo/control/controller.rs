//! State feedback over the delay on a verified model: feedforward, friction, inverse of the valve.

use crate::math::sqrt;
use crate::servo::control::anchor::Anchor;
use crate::servo::control::estimator::StateEstimator;
use crate::servo::control::holding::Holding;
use crate::servo::control::hop::Hop;
use crate::servo::control::load::Load;
use crate::servo::control::margins::Margins;
use crate::servo::control::null::NullOffset;
use crate::servo::control::poles::Poles;
use crate::servo::control::rest::{RestDesign, RestWindow};
use crate::servo::control::transfer::Transfer;
use crate::servo::control::tuning::Tuning;
use crate::servo::design::ControllerDesign;
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Setpoint};

/// Position controller whose bandwidth follows from margins.
///
/// ```text
/// r, x, v, p, d: reference and state when the command takes effect, a delay from now
/// flow = ( r''' + a2 r'' + a1 r' + friction s' + k2 (r'' + a2 r' + friction s - p) + k1 (r' - v) + k0 (r - x) - d ) / b0
/// u    = inverse of dead zone and offset (flow) + what is left of the last change of gains
/// ```
///
/// s is the sign of the next motion of the reference, filtered. The state comes from an observer on
/// the delayed flow and its prediction; a1 and b0 are those of the place. d is the integral action.
/// The poles are the fastest whose margins hold, see [`Margins`]. A new model changes no command at
/// the sample of its arrival: the difference is kept and fades, at most 50 full commands per s.
/// While friction holds the axis, the drive is brought to where it breaks away; at the target the
/// valve rests.
///
/// Known as: state feedback with disturbance observer and Smith predictor; bumpless transfer
/// (Astrom and Hagglund 2006).
///
/// # Examples
/// ```
/// use trendid::servo::{Config, Controller, Model, Motion, Setpoint, Travel};
/// let model = Model::linear(400.0, 20.0, 1.0e6);
/// let mut config = Config::new(0.001, 20.0, Travel { min: -200.0, max: 200.0 });
/// config.delay = 0.0;
/// config.controller.dead_volume = Some(f32::INFINITY); // as stiff at the ends as in the middle
/// let mut controller = Controller::new(&config.resolve()?, model);
/// // The model is its own plant here.
/// let mut plant = Motion::default();
/// for _ in 0..1000 {
///     let u = controller.update(&Setpoint::at(10.0), plant.position);
///     let u = u.clamp(-1.0, 1.0);
///     controller.applied(u);
///     model.advance(&mut plant, u, 0.001);
/// }
/// assert!((plant.position - 10.0).abs() < 0.05);
/// # Ok::<(), trendid::servo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    pub(super) design: ControllerDesign,
    pub(super) estimator: StateEstimator,
    pub(super) anchor: Anchor,
    pub(super) rest: RestWindow,
    /// Poles without derating with the natural frequency that they were found for, and the factor
    /// on their bandwidth.
    pub(super) poles: Poles,
    pub(super) found_for: f32,
    pub(super) margins: Option<Margins>,
    pub(super) factor: f32,
    /// Natural frequency of the model in the middle.
    pub(super) frequency: f32,
    /// Filtered sign of the next motion of the reference.
    pub(super) heading: f32,
    pub(super) null: NullOffset,
    pub(super) load: Load,
    pub(super) holding: Holding,
    pub(super) hop: Hop,
    /// Samples for which the axis was held while the reference rested before its motion.
    pub(super) pause: u32,
    /// Samples since the axis began to stick after which the valve rested last.
    pub(super) rested: u32,
    /// Error and reference at the last breakaway.
    pub(super) left: [f32; 2],
    /// Where the reference comes to rest, as far as it is known.
    pub(super) goal: Option<f32>,
    pub(super) transfer: Transfer,
}

impl Controller {
    /// A controller on `model`, at rest in zero; searches its poles: not for the 1 ms path.
    pub fn new(design: &crate::servo::Design, model: Model) -> Self {
        let mut controller = Self::provisional(&design.controller, model);
        controller.search(&model);
        controller.tune(model);
        controller
    }

    /// A controller on `model` with these poles, at rest in zero.
    pub(crate) fn with_poles(
        design: &ControllerDesign,
        model: Model,
        poles: Poles,
        margins: Option<Margins>,
    ) -> Self {
        let mut controller = Self {
            design: *design,
            estimator: StateEstimator::new(&design.estimator, model, poles),
            anchor: Anchor::new(&design.anchor),
            rest: RestWindow::new(&RestDesign {
                least: design.rest_window,
                most: design.rest_window,
                sticky: false,
                lead: 0.0,
            }),
            poles,
            found_for: sqrt(model.a1),
            margins,
            factor: 1.0,
            frequency: 1.0,
            heading: 0.0,
            null: NullOffset::default(),
            load: Load::default(),
            holding: Holding::NONE,
            hop: Hop::default(),
            pause: 0,
            rested: 0,
            left: [0.0; 2],
            goal: None,
            transfer: Transfer::default(),
        };
        controller.tune(model);
        controller
    }

    pub(super) const fn sample_time(&self) -> f32 {
        self.design.estimator.sample_time
    }

    /// The command for the setpoint of a delay from now, when it takes effect, and a measured
    /// position; [`Controller::applied`] must follow.
    ///
    /// Cost: see the table of instruction counts.
    #[inline]
    pub fn update(&mut self, r: &Setpoint, y: f32) -> f32 {
        let rests = r.is_rest();
        let error = r.position - self.estimator.now().position;
        let frozen = if rests {
            self.rest.freezes(error)
        } else {
            self.starts()
        };
        self.observe(y, r.position, frozen);
        let changes = self.head(r);
        self.bear(r);
        self.hop.follow(r.position, r.velocity);
        if rests {
            self.pauses();
            self.come_to_rest(r.position);
        } else {
            self.rest.wake();
        }
        let fading = self
            .transfer
            .fade(self.design.fade, self.design.transition_step);
        let command = self.law(r, rests, changes) + fading;
        let Some(arriving) = self.transfer.take() else {
            return command;
        };
        if let Some((poles, margins)) = arriving.poles {
            (self.poles, self.margins, self.found_for) = (poles, margins, self.frequency);
        }
        self.factor = arriving.factor.unwrap_or(self.factor);
        self.tune(arriving.model.unwrap_or(*self.estimator.model()));
        if arriving.model.is_some() {
            // What the model before could not explain.
            self.estimator.forget_disturbance();
            self.rest.forget();
            self.bear(r);
        }
        let changed = self.law(r, rests, changes);
        self.transfer.keep(command, changed)
    }

    /// The reference comes to rest there; `None`: nobody knows where.
    pub(crate) const fn head_for(&mut self, goal: Option<f32>) {
        self.goal = goal;
    }

    /// A controller on `model` that does little, until there are poles for it.
    pub(crate) fn provisional(design: &ControllerDesign, model: Model) -> Self {
        let poles = Tuning::slowest(&design.tuning, &model);
        Self::with_poles(design, model, poles, None)
    }

    /// The flow that the axis feels from now on, behind the delay.
    pub(crate) fn flow_in_force(&self) -> f32 {
        self.estimator.flow_in_force()
    }

    /// Samples from a command to its effect.
    pub(crate) const fn delay(&self) -> usize {
        self.design.estimator.delay
    }

    /// The motion when the next command takes effect, as far as what is on its way leads there.
    pub(crate) fn motion_ahead(&self) -> Motion {
        self.estimator.motion_ahead()
    }

    /// Stiffness of the axis where it is over that in the middle.
    pub(crate) const fn stiffness(&self) -> f32 {
        self.estimator.stiffness()
    }

    /// Whether friction holds the axis.
    pub(crate) const fn sticks(&self) -> bool {
        self.anchor.holds()
    }

    /// Whether friction holds the axis and the push that shall move it still grows.
    pub(crate) fn pushes(&self) -> bool {
        self.estimator.pushes()
    }

    /// Whether friction holds the axis, and a hunt still widens the window in which it rests.
    pub(crate) fn hunts(&self) -> bool {
        self.sticks() && self.rest.can_widen()
    }

    /// Samples since the axis began to stick, or to slide; without friction it has always slid.
    pub(crate) const fn since(&self) -> u32 {
        match self.rest.sticky() {
            true => self.anchor.since(),
            false => u32::MAX,
        }
    }

    /// The observed motion.
    pub fn motion(&self) -> Motion {
        self.estimator.motion()
    }

    /// The observed disturbance, as a flow.
    pub fn disturbance(&self) -> f32 {
        self.estimator.now().disturbance / self.estimator.step().b0
    }

    /// The model in use.
    pub const fn model(&self) -> &Model {
        self.estimator.model()
    }

    /// Bandwidth in rad/s, derating included.
    pub const fn bandwidth(&self) -> f32 {
        self.estimator.poles().bandwidth
    }

    /// Margins of the loop in the middle of the travel; `None` when no poles have the wanted ones
    /// and the slowest are in use.
    pub const fn margins(&self) -> Option<Margins> {
        self.margins
    }
}
