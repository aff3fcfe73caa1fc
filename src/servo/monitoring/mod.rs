//! What stops a loop whose sensor, valve or axis has a fault, while a verified model controls.
//!
//! Every monitor compares what the model expects of the commands with what the sensor shows. The
//! expectation comes from the commands alone ([`twin`]), so that no failing sensor enters it. Times
//! and distances follow from the model (natural frequency w, velocity gain C), from the accuracy of
//! a commissioning and from noise and resolution of the sensor; [`Bounds`](bounds::Bounds) derives
//! them when a model comes into force.
//!
//! | requirement | mechanism | time and distance | test (host-tests/tests/servo/faults.rs) |
//! |---|---|---|---|
//! | a reading that cannot be moves nothing | [`reading`]: bridged by the observer, counted | the same sample | a_spike_moves_nothing |
//! | a lasting jump stops the axis | [`reading`]: [`Reason::Implausible`] | 10 ms | every_fault_is_noticed_for_its_reason |
//! | readings that fail again and again stop the axis | [`gaps`]: [`Reason::SensorFault`] | 0.1 s | the same |
//! | a code that stays while the axis moves stops it | [`stuck_code`]: [`Reason::SensorStuck`] | some codes of motion | the same |
//! | an axis that does not move stops | [`shortfall`]: [`Reason::Blocked`] | two deflections of the friction, 3.5 where it stood before, for 1/(2 w) | its own: a_sound_axis_is_never_short_and_a_fault_soon_is |
//! | motion against the command stops | [`shortfall`]: the valve closes | two deflections of the friction | the same |
//! | and is named | [`response`], [`closing`]: [`Reason::WrongSign`], [`Reason::ValveStuck`] | 3/w or twice that behind the closed valve | their own |
//! | motion beyond the command stops | [`obedience`]: [`Reason::ValveStuck`] | 1/(2 w) beyond the slack | every_fault_is_noticed_for_its_reason |
//! | no blow at an end of the travel | [`travel`]: [`Reason::TravelEnd`] | before the stopping distance is used up | the same |
//! | an error that stays stops the axis | [`following`]: [`Reason::FollowingError`] | 10/w | the same |
//! | the full command does not stay | [`saturation`]: [`Reason::Saturated`] | the travel at a quarter of C | the same |
//! | an oscillation at rest is noticed, then slower | [`oscillation`]: counted, the bandwidth is derated | 4 reversals | an_oscillation_is_noticed_and_slowed |
//! | an axis that moves at rest is reported | [`unrest`]: counted, whatever its frequency | two resolutions and two standard deviations | its own: a_move_at_rest_is_counted |
//! | normal work raises no alarm | the derivation of every bound | | normal_work_raises_no_alarm |
//! | the axis stops | [`stop`]: brake on the observer, then the valve in its middle | 10/w | every_fault_is_noticed_for_its_reason |
//!
//! [`Reason::Implausible`]: crate::servo::Reason::Implausible
//! [`Reason::SensorFault`]: crate::servo::Reason::SensorFault
//! [`Reason::SensorStuck`]: crate::servo::Reason::SensorStuck
//! [`Reason::Blocked`]: crate::servo::Reason::Blocked
//! [`Reason::WrongSign`]: crate::servo::Reason::WrongSign
//! [`Reason::ValveStuck`]: crate::servo::Reason::ValveStuck
//! [`Reason::TravelEnd`]: crate::servo::Reason::TravelEnd
//! [`Reason::FollowingError`]: crate::servo::Reason::FollowingError
//! [`Reason::Saturated`]: crate::servo::Reason::Saturated

pub(crate) mod bounds;
mod closing;
mod counters;
mod following;
mod gaps;
mod monitors;
mod obedience;
mod oscillation;
pub(crate) mod reading;
mod response;
mod saturation;
mod shortfall;
pub(crate) mod stop;
mod stuck_code;
mod travel;
mod twin;
mod unrest;

pub use counters::FaultCounters;
pub(crate) use following::Efforts;
pub(crate) use monitors::{Alarm, Monitors, Seen};

#[cfg(test)]
mod tests;
