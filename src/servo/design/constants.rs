//! The tuned constants of the loop: value, unit, reason, and the test that holds them.
//!
//! Times are in s and rates per s, so that they mean the same at every sample time;
//! [`Config::resolve`] turns them into samples. They were found at 1 kHz on the simulated pneumatic
//! axis of the host tests. The tests are those of the position loop in `host-tests`; a test that is
//! named over a group holds the group as a whole.
//!
//! [`Config::resolve`]: crate::servo::Config::resolve

// Defaults that follow from the bandwidth w of the plant (rad/s) and the travel L.
// Held by: the_axis_commissions_itself_and_follows, changes_in_motion_are_survived.

/// Noise over L: 10 um on 400 mm, a magnetostrictive transducer.
pub(crate) const NOISE_RATIO: f32 = 2.5e-5;
/// Stated bandwidth over the natural frequency that was found: the ratios to w were found with a
/// cautious w.
pub(crate) const ROUGH_RATIO: f32 = 0.83;
/// Bandwidth in rad/s of the fastest axis, for limits that hold before a model exists.
pub(crate) const BANDWIDTH_MAX: f32 = 150.0;
/// Velocity limit in L per s.
pub(crate) const VELOCITY_RATIO: f32 = 2.0;
/// Acceleration over L w^2, and jerk over L w^3: a move of some 15 % of L stays just below
/// saturation of the valve.
pub(crate) const ACCELERATION_RATIO: f32 = 0.04;
/// Least rest window over one code and two standard deviations: the mean of a rest is better known.
pub(crate) const REST_WINDOW_GRAINS: f32 = 1.0;
/// Largest breakaway over Coulomb friction.
pub(crate) const BREAKAWAY_RATIO: f32 = 2.5;
/// Time over 1/w in which the push of a sticking axis meets any breakaway and dead zone.
pub(crate) const PUSH_TIME_RATIO: f32 = 10.0;
/// Largest velocity gain over L, per s.
pub(crate) const GAIN_MAX_RATIO: f32 = 50.0;
/// Velocity over L per s below which the axis does not count as moving.
pub(crate) const SPEED_MIN_RATIO: f32 = 0.05;
/// Movement over L within the excitation below which the axis is blocked.
pub(crate) const TRAVEL_MIN_RATIO: f32 = 2e-3;
/// Tracking error over L up to which a model in use is not replaced.
pub(crate) const ERROR_DEADBAND_RATIO: f32 = 5e-3;
/// The same over that one in a slow motion: there an error counts by the time it means, half of
/// 1/w, in which no command moves the axis far.
pub(crate) const ERROR_LEAST_RATIO: f32 = 0.2;
pub(crate) const LAG_RATIO: f32 = 0.5;

// Filters that follow from w.
// Held by: the_axis_commissions_itself_and_follows.

/// Poles of the trends over w: the filter of the identifier, twice the plant.
pub(crate) const TRENDS_RATIO: f32 = 2.0;
/// Typical movement of the output over L, for the scales of the identifier.
pub(crate) const OUTPUT_RANGE_RATIO: f32 = 0.1;
/// Poles of the alpha-beta-gamma filter over w: its lag is small against the stopping time.
pub(crate) const TRACKING_RATIO: f32 = 12.0;
/// Rate of the observers of a validation over w: they settle before the free simulation begins.
pub(crate) const VALIDATION_OBSERVER_RATIO: f32 = 6.0;
/// Largest rate of these per sample: an explicit correction is unstable from a half on.
pub(crate) const VALIDATION_STEP_MAX: f32 = 0.3;
/// Time over that of three equal poles after which they have a hundredth of their way to go: of the
/// observers of a validation, and of the alpha-beta-gamma filter.
pub(crate) const SETTLING_RATIO: f32 = 8.4;
/// Time over 1/w of a window of free simulation: half a period.
pub(crate) const VALIDATION_TIME_RATIO: f32 = 3.1;
/// Pole over w of a motion that is taken over and runs out.
pub(crate) const RUN_OUT_RATIO: f32 = 1.0;
/// Time over that of the filter of the trends after a breakaway in which the filtered signals still
/// contain friction: of what three poles held, a tenth is left then.
pub(crate) const SETTLED_RATIO: f32 = 5.3;
/// Time constant in s of the excitation monitor: shorter than a move, longer than a level.
pub(crate) const MONITOR_TIME: f32 = 0.05;
// Held by: a_unit_too_small_for_the_accelerations_is_refused,
// a_stiff_axis_of_any_length_is_one_in_millimetres.
/// Largest w^2 L: an axis of 1.6 m with the largest natural frequency that is looked for, in mm.
/// Friction, as an acceleration, is an input of the identifier, whose typical size may be 1e9: that
/// of this axis is 1e7.
pub(crate) const ACCELERATION_MAX: f32 = 1e8;

// Delay.
// Held by: one_axis_of_each_family_runs_through.

/// Longest delay in samples.
pub(crate) const DELAY_MAX: usize = 40;

// Sensor.
// Held by: readings_that_fail_now_and_then_are_bridged,
// faults_are_refused_for_the_right_reason_and_the_gains_are_kept.

/// Time in s of consecutive sensor errors that stops the axis; fewer are bridged by prediction.
pub(crate) const SENSOR_ERROR_TIME: f32 = 0.003;

// Stick-slip friction.
// Held by: the_axis_commissions_itself_and_follows (sines through reversals),
// changes_in_motion_are_survived (doubled friction).

/// Drive over friction up to which a stop ends in sticking, and at which an axis without
/// measurements starts.
pub(crate) const STOP_HOLD_RATIO: f32 = 1.2;

// Change of gains.
// Held by: a_change_of_gains_steps_the_command_by_at_most_one_percent.

/// Largest rate per s at which the trace of a change of gains fades, in full commands: no step, and
/// over before the axis has moved by it. A tenth of that left the law without its command for up
/// to 0.2 s.
pub(crate) const TRANSITION_RATE_MAX: f32 = 50.0;

// Supervision.
// Held by: faults_are_refused_for_the_right_reason_and_the_gains_are_kept,
// changes_in_motion_are_survived.

/// Time in s between two candidates, and the length of `Verified`.
pub(crate) const LOOK_TIME: f32 = 0.016;
/// Time in s after a rejected estimate without candidates; also the length of `Rejected`.
pub(crate) const REJECTION_TIME: f32 = 0.064;
/// Time in s without motion after which the model is no longer adapted.
pub(crate) const STILL_TIME: f32 = 0.2;
/// Standard deviations, squared, at which the sign of b0 counts as known.
pub(crate) const SIGN_SIGMA_SQUARED: f32 = 9.0;
/// Variance of the damping over that of gain and frequency, at most: four times the standard
/// deviation.
pub(crate) const DAMPING_VARIANCE_RATIO: f32 = 16.0;
/// Largest a2^2 / a1: a damping of 3.
pub(crate) const DAMPING_MAX: f32 = 36.0;
/// Largest dead zone and offset of a valve, as commands.
pub(crate) const VALVE_MAX: f32 = 0.3;
/// Part of friction and dead zone that a verified model may not know.
pub(crate) const UNKNOWN_PART: f32 = 0.5;
/// Flow by which its dead zone may be wrong however narrow it is: by no more than that is it found
/// on about nine of ten axes of a family.
pub(crate) const UNKNOWN_FLOW: f32 = 0.03;
/// Time constants in s of the innovation's variance: recent, and usual.
pub(crate) const INNOVATION_FAST_TIME: f32 = 0.03;
pub(crate) const INNOVATION_SLOW_TIME: f32 = 2.0;
/// Time constant in s in which the largest tracking error is forgotten.
pub(crate) const PEAK_ERROR_TIME: f32 = 1.0;
/// Relative standard deviation of a1, a2, b0 and friction after a verified model, and after a
/// change of the drive.
pub(crate) const REOPENED_STD: f32 = 0.1;
pub(crate) const CHANGED_STD: f32 = 0.5;
/// Relative standard deviation of a change of a2/a1 and of friction/a1: of damping and friction
/// over stiffness, in which the mass cancels.
pub(crate) const TIED_STD: [f32; 2] = [0.5, 0.35];

// Monitoring: times over 1/w, with w and the velocity gain C of the model in force.
// Held by: every_fault_is_noticed_for_its_reason, normal_work_raises_no_alarm.

/// Window of the expected and the measured displacement: two thirds of a period, so that a step is
/// in it as a whole.
pub(crate) const EXPECTATION_TIME_RATIO: f32 = 4.0;
/// Flow by which dead zone and offset of a verified model may be wrong together: each by as much.
pub(crate) const FLOW_SLACK: f32 = 2.0 * UNKNOWN_FLOW;
/// Deflections `friction / a1` by which an axis that friction holds and its expectation differ: a
/// breakaway, and the friction that stops the other one on the far side.
pub(crate) const HELD_DEFLECTIONS: f32 = BREAKAWAY_RATIO + 1.0;
/// Time without motion, and against the command: the rise time of the drive, and half of it.
pub(crate) const NO_MOTION_TIME_RATIO: f32 = 1.0;
pub(crate) const OPPOSITE_TIME_RATIO: f32 = 0.5;
/// Displacement over speed by which a swing and its expectation may differ in half a wave: 2 at the
/// natural frequency of the model, sqrt(3) times that under a load of three times the mass, and
/// half as much again where the loop is unstable with it and the swing grows by half from one half
/// wave to the next.
pub(crate) const SWING_TIME_RATIO: f32 = 5.2;
/// Time after which an axis behind a closed valve has lost its speed: half a period.
pub(crate) const CLOSING_TIME_RATIO: f32 = 3.0;
/// Lag of a loop at a quarter of the bandwidth of its drive.
pub(crate) const LAG_TIME_RATIO: f32 = 4.0;
/// Time after which a following error stays: more than a period.
pub(crate) const FOLLOWING_TIME_RATIO: f32 = 10.0;
/// Stopping distance from a speed v under the full reverse command: the force grows at b0 = C w^2,
/// so that v is gone after `t = sqrt(2 v/C)/w` and `2 v t/3`. `sqrt(x)` is below its tangent at x
/// = 0.1, and the axis may still be driven for half of that time: `v (0.25/w) + 2 v^2/(C w)`.
pub(crate) const FORCE_TIME_RATIO: f32 = 0.25;
pub(crate) const BRAKE_RATIO: f32 = 2.0;
/// Crossings of the travel at C that a full command may last: one at a quarter of C.
pub(crate) const SATURATED_CROSSINGS: f32 = 4.0;
/// Longest controlled stop.
pub(crate) const STOP_TIME_RATIO: f32 = 10.0;
/// Time in s of implausible readings in a row that are a jump: the bridging by prediction is good
/// for so long.
pub(crate) const JUMP_TIME: f32 = 0.01;
/// Time constant in s of the mean residual of readings, and of the share of missing ones.
pub(crate) const RESIDUAL_TIME: f32 = 1.0;
pub(crate) const GAP_TIME: f32 = 0.05;
/// Standard deviation over resolution from which on noise changes the code often, wherever between
/// two codes the axis stands: quantisation alone gives up to a half, on the edge of two.
pub(crate) const CODE_CHANGING_NOISE: f32 = 0.75;
/// How much longer than the longest run of equal codes seen so far a run must be that such noise
/// does not explain, and its least time in s.
pub(crate) const STUCK_RUN_RATIO: u32 = 8;
pub(crate) const LEAST_RUN_TIME: f32 = 0.01;
/// Longest time in s between two reversals of an oscillation, and time in s in which an axis comes
/// to rest.
pub(crate) const CYCLE_PAUSE: f32 = 1.0;
pub(crate) const CYCLE_SETTLING: f32 = 0.5;
/// Largest acceleration over L w^2 while there is no model: twice what an axis takes that crosses
/// its travel in 16/w.
pub(crate) const FIRST_ACCELERATION_RATIO: f32 = 0.25;
/// Command over its range from which on it is full.
pub(crate) const FULL_COMMAND: f32 = 0.98;
/// Factor on the bandwidth at each oscillation, and the least one.
pub(crate) const DERATING: f32 = 0.7;
pub(crate) const DERATING_MIN: f32 = 0.49;
/// Largest rate of the alpha-beta-gamma filter per sample: it is an explicit filter.
pub(crate) const TRACKING_STEP_MAX: f32 = 0.5;
