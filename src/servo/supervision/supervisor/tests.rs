//! The states of the supervisor, and what moves it from one to the next.

use super::*;
use crate::servo::config::Config;
use crate::servo::control::place::PlacedFlow;
use crate::servo::error::Error;
use crate::servo::motion::{Motion, Travel};
use crate::servo::supervision::event::Spare;

pub(crate) const MODEL: Model = Model::linear(625.0, 25.0, 1e6);
pub(crate) const OTHER: Model = Model::linear(500.0, 30.0, 9e5);

/// A supervisor with a model, before the first motion.
pub(crate) fn installed() -> Result<Supervisor, Error> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let design = Config::new(1e-3, 25.0, travel).resolve()?;
    let mut supervisor = Supervisor::new(&design.supervision);
    assert_eq!(supervisor.install(MODEL), Ok(()));
    Ok(supervisor)
}

/// A sample of an axis with this velocity, behind its reference.
pub(crate) fn at(velocity: f32) -> LoopSample {
    LoopSample {
        motion: Motion {
            velocity,
            ..Motion::default()
        },
        y: 0.0,
        flow: PlacedFlow::in_the_middle(0.0),
        same_code: false,
        sticks: false,
        speed: 0.0,
        error: 10.0,
        innovation: None,
        spare: Spare::Thought,
    }
}

pub(crate) fn certain(model: Model) -> Candidate {
    Candidate {
        variances: [4.0, 9.0, 16.0],
        ..Candidate::known(model)
    }
}

#[test]
fn after_months_in_one_state_the_estimate_is_looked_at_as_often_as_before() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    supervisor.ticks = u32::MAX - 100;
    let seen = at(100.0);
    let mut looks = 0;
    for _ in 0..1600 {
        assert_eq!(supervisor.update(&seen), Event::None);
        looks += u32::from(supervisor.looks());
    }
    assert_eq!(looks, 100);
    Ok(())
}

#[test]
fn motion_in_either_direction_thaws_and_standstill_freezes() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let least = supervisor.design.min_speed;
    for speed in [least, -least, 0.0] {
        assert_eq!(supervisor.update(&at(speed)), Event::None);
        assert_eq!(supervisor.state(), State::Frozen, "{speed}");
    }
    for direction in [1.0, -1.0] {
        let _ = supervisor.update(&at(1.001 * direction * least));
        assert_eq!(supervisor.state(), State::Adapting);
        assert_eq!(supervisor.still_for, 0);
        // It freezes when it has not moved for `still` samples, and one with motion begins anew.
        for _ in 0..supervisor.design.still {
            let _ = supervisor.update(&at(0.0));
            assert_eq!(supervisor.state(), State::Adapting);
        }
        let _ = supervisor.update(&at(2.0 * direction * least));
        for _ in 0..supervisor.design.still {
            let _ = supervisor.update(&at(0.0));
            assert_eq!(supervisor.state(), State::Adapting);
        }
        let _ = supervisor.update(&at(0.0));
        assert_eq!(supervisor.state(), State::Frozen);
    }
    Ok(())
}

/// Samples until a state is left, with the axis at rest.
fn lasts(supervisor: &mut Supervisor, state: State) -> u32 {
    supervisor.enter(state);
    let mut samples = 0;
    while supervisor.state() == state && samples < 1_000_000 {
        assert_eq!(supervisor.update(&at(0.0)), Event::None);
        samples += 1;
    }
    samples
}

#[test]
fn states_that_pass_last_as_long_as_designed() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let design = supervisor.design.clone();
    assert_eq!(lasts(&mut supervisor, State::Verified), design.look + 1);
    assert_eq!(supervisor.state(), State::Adapting);
    // An estimate that was wrong itself begins again soon; where a commissioning found nothing, the
    // axis waits as long as it was excited.
    assert_ne!(design.rejection, design.excite);
    for (reason, samples) in [
        (Reason::Unstable, design.rejection),
        (Reason::NotFinite, design.rejection),
        (Reason::PoorFit, design.excite),
        (Reason::Uncertain, design.excite),
    ] {
        let rejected = State::Rejected(reason);
        assert_eq!(lasts(&mut supervisor, rejected), samples + 1, "{reason:?}");
        assert_eq!(supervisor.state(), State::Frozen);
    }
    for state in [State::Idle, State::Failed(Reason::Blocked), State::Exciting] {
        assert_eq!(lasts(&mut supervisor, state), 1_000_000);
    }
    Ok(())
}

/// How often an estimate is looked at in so many samples.
fn looks(supervisor: &mut Supervisor, seen: &LoopSample, samples: u32) -> usize {
    (0..samples)
        .filter(|_| {
            let _ = supervisor.update(seen);
            supervisor.looks()
        })
        .count()
}

#[test]
fn the_estimate_is_looked_at_while_the_axis_moves_and_no_window_lasts() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let design = supervisor.design.clone();
    supervisor.enter(State::Adapting);
    // Not in the first moments, then once in `look` samples, at their end.
    let first = looks(&mut supervisor, &at(100.0), design.rejection);
    assert_eq!(first, 0);
    assert_eq!(looks(&mut supervisor, &at(100.0), 10 * design.look), 10);
    // At rest, and in the other states, there is nothing to see.
    assert_eq!(looks(&mut supervisor, &at(0.0), 2 * design.look), 0);
    for state in [
        State::Idle,
        State::Exciting,
        State::Identifying,
        State::Failed(Reason::Blocked),
    ] {
        supervisor.enter(state);
        assert_eq!(looks(&mut supervisor, &at(100.0), 2 * design.look), 0);
    }
    // Nor while a window lasts.
    supervisor.enter(State::Adapting);
    assert_eq!(supervisor.submit(&certain(OTHER)), Event::None);
    let lasts = design.validation.observe + design.validation.window;
    assert_eq!(looks(&mut supervisor, &at(100.0), lasts - 1), 0);
    Ok(())
}

#[test]
fn an_error_counts_beyond_the_dead_band_and_in_a_slow_motion_by_its_time() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let design = supervisor.design.clone();
    supervisor.enter(State::Adapting);
    let (least, lag) = (design.error_least, design.lag);
    for (error, speed, count) in [
        (0.99 * least, 0.0, 0),
        (1.01 * least, 0.0, 10),
        (-2.0 * least, 2.01 * least / lag, 0),
        (-2.0 * least, -1.99 * least / lag, 10),
        (0.99 * design.error_deadband, 1e6, 0),
        (1.01 * design.error_deadband, 1e6, 10),
        (-2.0 * design.error_deadband, 0.0, 10),
    ] {
        // A reference that is followed asks for nothing.
        let mut seen = LoopSample {
            error: 0.0,
            ..at(100.0)
        };
        let _ = looks(&mut supervisor, &seen, 10_000);
        assert_eq!(looks(&mut supervisor, &seen, 10 * design.look), 0);
        (seen.error, seen.speed) = (error, speed);
        let found = looks(&mut supervisor, &seen, 10 * design.look);
        assert_eq!(found, count, "{error} at {speed}");
    }
    Ok(())
}

#[test]
fn a_candidate_that_is_refused_leaves_the_model_and_is_counted() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let vague = Candidate {
        gain_variance: 1e3,
        ..certain(OTHER)
    };
    assert_eq!(supervisor.submit(&vague), Event::None);
    assert_eq!(supervisor.state(), State::Adapting);
    assert_eq!(supervisor.refusal(), Some(Reason::Uncertain));
    assert_eq!(supervisor.counts(), (0, 1));
    // An estimate that is wrong itself begins again from the model in use.
    for (a1, reason) in [(f32::NAN, Reason::NotFinite), (-1.0, Reason::Unstable)] {
        supervisor.enter(State::Adapting);
        let wrong = certain(Model { a1, ..OTHER });
        assert_eq!(supervisor.submit(&wrong), Event::Restored(MODEL));
        assert_eq!(supervisor.state(), State::Rejected(reason));
        assert_eq!(supervisor.refusal(), Some(reason));
    }
    assert_eq!(supervisor.counts(), (0, 3));
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    // Outside of control there is nothing to go back to.
    supervisor.enter(State::Identifying);
    assert_eq!(supervisor.refuse(Reason::Unstable), Event::None);
    assert_eq!(supervisor.state(), State::Identifying);
    Ok(())
}

#[test]
fn a_commissioning_ends_with_a_model_or_with_the_one_before() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.begin();
    assert_eq!(
        (supervisor.state(), supervisor.refusal()),
        (State::Exciting, None)
    );
    supervisor.commission(false);
    assert_eq!((supervisor.state(), supervisor.ticks), (State::Exciting, 1));
    supervisor.commission(true);
    assert_eq!(
        (supervisor.state(), supervisor.ticks),
        (State::Identifying, 2)
    );
    supervisor.variances = [1.0; 3];
    assert_eq!(supervisor.commissioned(OTHER), Event::Accepted(OTHER));
    assert_eq!(supervisor.state(), State::Verified);
    assert_eq!(supervisor.verified_model(), Some(OTHER));
    assert_eq!(supervisor.verified_std(), [f32::INFINITY; 3]);
    assert_eq!(supervisor.counts(), (1, 0));
    // A model that may not control, or none: the one before comes back into force.
    supervisor.begin();
    let wild = Model { a2: -1.0, ..OTHER };
    assert_eq!(supervisor.commissioned(wild), Event::Restored(OTHER));
    assert_eq!(supervisor.state(), State::Rejected(Reason::Unstable));
    assert_eq!(supervisor.give_up(Reason::PoorFit), Event::Restored(OTHER));
    assert_eq!(supervisor.refusal(), Some(Reason::PoorFit));
    // With a fault of the machine, or without a model, the axis stops.
    assert_eq!(supervisor.give_up(Reason::SensorStuck), Event::Stopped);
    assert_eq!(supervisor.state(), State::Failed(Reason::SensorStuck));
    let mut fresh = Supervisor::new(&supervisor.design);
    assert_eq!(fresh.give_up(Reason::PoorFit), Event::Stopped);
    assert_eq!(fresh.state(), State::Failed(Reason::PoorFit));
    Ok(())
}

#[test]
fn a_stop_keeps_the_model_and_says_why() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    assert_eq!(supervisor.submit(&certain(OTHER)), Event::None);
    supervisor.fail(Reason::Implausible);
    assert_eq!(supervisor.state(), State::Failed(Reason::Implausible));
    assert_eq!(supervisor.refusal(), Some(Reason::Implausible));
    assert_eq!(supervisor.comparison, Comparison::Rests);
    supervisor.abort();
    assert_eq!(supervisor.state(), State::Idle);
    assert_eq!(supervisor.refusal(), Some(Reason::Aborted));
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    // Without a window there is nothing to compare.
    assert_eq!(supervisor.compare(&at(1.0)), Event::None);
    assert_eq!(supervisor.counts(), (0, 0));
    Ok(())
}

#[test]
fn a_loop_that_is_designed_anew_looks_as_often_as_the_new_design_says() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let mut design = supervisor.design.clone();
    design.look *= 2;
    supervisor.redesign(design.clone());
    assert_eq!(supervisor.design, design);
    assert_eq!(lasts(&mut supervisor, State::Verified), design.look + 1);
    Ok(())
}
