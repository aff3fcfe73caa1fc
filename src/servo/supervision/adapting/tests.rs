//! Candidates beside a drive: what becomes of them in control.

use super::*;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::supervision::state::Reason;
use crate::servo::supervision::supervisor::tests::{MODEL, OTHER, at, certain, installed};

/// A sample of `drive` under a flow that changes its sign four times per second.
fn step(motion: &mut Motion, drive: &Model, k: u32) -> Observation {
    let flow = if (k / 250).is_multiple_of(2) {
        0.3
    } else {
        -0.3
    };
    let seen = Observation {
        motion: *motion,
        y: motion.position,
        flow,
        ..at(motion.velocity)
    };
    drive.advance(motion, flow, 1e-3);
    seen
}

/// What becomes of `candidate` on `drive`; the events, and the samples of its validation.
fn judged(supervisor: &mut Supervisor, drive: Model, candidate: Model) -> (Option<Event>, u32) {
    let mut motion = Motion {
        position: 200.0,
        ..Motion::default()
    };
    supervisor.enter(State::Adapting);
    for k in 0..2000 {
        assert_eq!(
            supervisor.update(&step(&mut motion, &drive, k)),
            Event::None
        );
    }
    let seen = step(&mut motion, &drive, 2000);
    assert_eq!(supervisor.submit(&certain(candidate), &seen), Event::None);
    let mut samples = 0;
    for k in 2001..20_000 {
        let event = supervisor.update(&step(&mut motion, &drive, k));
        samples += 1;
        if supervisor.validation.is_none() {
            return (Some(event), samples);
        }
    }
    (None, samples)
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_better_model_replaces_the_one_in_use_with_its_deviations() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let design = supervisor.design.validation;
    let (event, samples) = judged(&mut supervisor, OTHER, OTHER);
    assert_eq!(event, Some(Event::Accepted(OTHER)));
    // The first sample of all was that of the submission.
    assert_eq!(samples, design.observe + design.window);
    assert_eq!(supervisor.state(), State::Adapting);
    assert_eq!(supervisor.verified_model(), Some(OTHER));
    assert_eq!(supervisor.verified_std(), [2.0, 3.0, 4.0]);
    assert_eq!((supervisor.counts(), supervisor.refusal()), ((1, 0), None));
    let report = supervisor.fit_report();
    assert_eq!(report.samples, design.window);
    assert!(report.r_squared() > 0.999, "{report:?}");
    Ok(())
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_model_that_is_no_better_is_refused() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let (event, _) = judged(&mut supervisor, MODEL, OTHER);
    assert_eq!(event, Some(Event::None));
    assert_eq!(supervisor.refusal(), Some(Reason::NotBetter));
    assert_eq!(supervisor.counts(), (0, 1));
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    // An axis that creeps says nothing of two models.
    let gain = 3.0 * supervisor.design.min_speed / 0.3;
    let creeps = Model {
        b0: gain * MODEL.a1,
        ..MODEL
    };
    let (event, _) = judged(&mut supervisor, creeps, OTHER);
    assert_eq!(event, Some(Event::None));
    assert_eq!(
        supervisor.counts(),
        (0, 1),
        "too little motion says nothing"
    );
    let opposite = Model {
        b0: -0.5 * MODEL.b0,
        ..MODEL
    };
    let (event, _) = judged(&mut supervisor, opposite, OTHER);
    assert_eq!(event, Some(Event::None));
    assert_eq!(supervisor.refusal(), Some(Reason::PoorFit));
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    Ok(())
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_change_of_the_drive_or_a_stick_ends_a_validation() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let quiet = Observation {
        innovation: Some(0.01),
        ..at(100.0)
    };
    supervisor.enter(State::Adapting);
    for _ in 0..=supervisor.design.look {
        assert_eq!(supervisor.update(&quiet), Event::None);
    }
    assert_eq!(supervisor.submit(&certain(OTHER), &quiet), Event::None);
    assert_eq!(supervisor.update(&quiet), Event::None);
    assert!(supervisor.validation.is_some());
    let sticks = Observation {
        sticks: true,
        ..quiet
    };
    assert_eq!(supervisor.update(&sticks), Event::None);
    assert_eq!(supervisor.validation, None);
    assert_eq!(supervisor.submit(&certain(OTHER), &quiet), Event::None);
    let changed = Observation {
        innovation: Some(1.0),
        ..quiet
    };
    assert_eq!(supervisor.update(&changed), Event::Changed);
    assert_eq!(supervisor.validation, None);
    assert_eq!(supervisor.state(), State::Adapting);
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    Ok(())
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_change_right_after_the_state_began_is_its_transient() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let sample = |innovation| Observation {
        innovation: Some(innovation),
        ..at(100.0)
    };
    let _ = supervisor.update(&sample(0.01));
    for _ in 1..supervisor.design.look {
        assert_eq!(supervisor.update(&sample(1.0)), Event::None);
    }
    Ok(())
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn the_largest_error_is_remembered_and_forgotten() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let sample = |error| Observation { error, ..at(100.0) };
    for error in [-3.0, 1.0] {
        let _ = supervisor.update(&sample(error));
    }
    let leak = supervisor.design.peak_error_leak;
    assert!((supervisor.peak_error - 3.0 * (1.0 - leak)).abs() < 1e-6);
    // Half of it is gone after 0.69 of its time.
    let mut samples = 0;
    while supervisor.peak_error > 1.5 {
        let _ = supervisor.update(&sample(0.0));
        samples += 1;
    }
    let half = core::f32::consts::LN_2 / leak;
    assert!(
        (samples as f32 / half - 1.0).abs() < 0.01,
        "{samples} of {half}"
    );
    let _ = supervisor.update(&sample(7.0));
    assert_eq!(supervisor.peak_error, 7.0);
    Ok(())
}
