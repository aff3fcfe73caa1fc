//! Candidates beside a drive: what becomes of them in control.

mod hidden;

use super::*;
use crate::servo::control::place::PlacedFlow;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::supervision::evidence::Evidence;
use crate::servo::supervision::screening::Candidate;
use crate::servo::supervision::state::Reason;
use crate::servo::supervision::supervisor::tests::{MODEL, OTHER, at, certain, installed};

/// A sample of `drive` under a flow that changes its sign four times per second.
fn step(motion: &mut Motion, drive: &Model, k: u32) -> LoopSample {
    let flow = if (k / 250).is_multiple_of(2) {
        0.3
    } else {
        -0.3
    };
    let seen = LoopSample {
        motion: *motion,
        y: motion.position,
        flow: PlacedFlow::in_the_middle(flow),
        ..at(motion.velocity)
    };
    drive.advance(motion, flow, 1e-3);
    seen
}

/// Windows with `candidate` on `drive` until something comes of them; the event, and the samples of
/// all windows.
fn judged(supervisor: &mut Supervisor, drive: Model, candidate: Model) -> (Event, u32) {
    let mut motion = Motion::at(200.0);
    supervisor.enter(State::Adapting);
    let mut samples = 0;
    for k in 0..20_000 {
        let seen = step(&mut motion, &drive, k);
        samples += u32::from(supervisor.running().is_some_and(|w| !w.is_over()));
        let event = supervisor.update(&seen);
        if event != Event::None || supervisor.counts() != (0, 0) {
            return (event, samples);
        }
        // At its start the axis is slower than later.
        if k > 2000 && supervisor.comparison.rests() {
            assert_eq!(supervisor.submit(&certain(candidate)), Event::None);
        }
    }
    (Event::None, samples)
}

#[test]
fn a_better_model_replaces_the_one_in_use_with_its_deviations() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let design = supervisor.design.validation;
    let drive = Model::linear(250.0, 30.0, 1e6);
    let (event, samples) = judged(&mut supervisor, drive, drive);
    assert_eq!(event, Event::Accepted(drive));
    // The first sample of each window was that of the submission.
    assert_eq!(samples, 2 * (design.observe + design.window));
    assert_eq!(supervisor.state(), State::Adapting);
    assert_eq!(supervisor.verified_model(), Some(drive));
    assert_eq!(supervisor.verified_std(), [2.0, 3.0, 4.0]);
    assert_eq!((supervisor.counts(), supervisor.refusal()), ((1, 0), None));
    // The windows were about the model before, the load of which was a lighter one.
    let mut evidence = Evidence::NONE;
    evidence.replaced(&MODEL, &drive);
    assert!(evidence != Evidence::NONE && supervisor.evidence == evidence);
    let report = supervisor.fit_report();
    assert_eq!(report.samples, design.window);
    assert!(report.r_squared() > 0.999, "{report:?}");
    Ok(())
}

#[test]
fn a_model_that_is_no_better_is_refused() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let (event, _) = judged(&mut supervisor, MODEL, OTHER);
    assert_eq!(event, Event::None);
    assert_eq!(supervisor.refusal(), Some(Reason::NotBetter));
    assert_eq!(supervisor.counts(), (0, 1));
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    // An axis that moves by less than the least movement says nothing of two models.
    let mut supervisor = installed()?;
    supervisor.design.min_travel *= 5.0;
    let gain = 3.0 * supervisor.design.min_speed / 0.3;
    let creeps = Model {
        b0: gain * MODEL.a1,
        ..MODEL
    };
    let (event, samples) = judged(&mut supervisor, creeps, OTHER);
    assert!(event == Event::None && samples > 0);
    assert_eq!(
        supervisor.counts(),
        (0, 0),
        "too little motion says nothing"
    );
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    Ok(())
}

#[test]
fn another_load_is_found_without_an_estimate() -> Result<(), Error> {
    let heavy = Model::linear(MODEL.a1 / 3.0, MODEL.a2 / 3.0, MODEL.b0 / 3.0);
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let vague = Candidate {
        gain_variance: 1e3,
        ..certain(OTHER)
    };
    let mut motion = Motion::at(200.0);
    let (mut event, mut k) = (Event::None, 0);
    while event == Event::None && k < 20_000 {
        let seen = step(&mut motion, &heavy, k);
        event = supervisor.update(&seen);
        if supervisor.comparison.rests() && event == Event::None {
            event = supervisor.submit(&vague);
        }
        k += 1;
    }
    let Event::Accepted(model) = event else {
        panic!("{event:?}");
    };
    assert!((model.a1 / heavy.a1 - 1.0).abs() < 0.02, "{model:?}");
    assert!((model.b0 / heavy.b0 - 1.0).abs() < 0.02, "{model:?}");
    assert_eq!(supervisor.refusal(), None);
    let [a1, a2, b0] = supervisor.verified_std();
    assert!((a1 / model.a1 - 0.18).abs() < 1e-3 && (b0 / model.b0 - 0.18).abs() < 1e-3);
    assert!((a2 / model.a2 - 0.18).abs() < 1e-3);
    Ok(())
}

#[test]
fn a_winner_that_may_not_control_is_refused() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let wild = Model {
        dead_zone: 0.5,
        ..Model::linear(2500.0, 10.0, 2e6)
    };
    supervisor.evidence.reconsider(wild);
    let mut motion = Motion::at(200.0);
    let mut event = Event::None;
    for k in 0..2000 {
        let seen = step(&mut motion, &wild, k);
        event = supervisor.update(&seen);
        if event != Event::None {
            break;
        }
        if supervisor.comparison.rests() && k > 500 {
            let _ = supervisor.submit(&certain(OTHER));
        }
    }
    assert_eq!(event, Event::Restored(MODEL));
    assert_eq!(supervisor.refusal(), Some(Reason::OutOfRange));
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    Ok(())
}

#[test]
fn a_change_of_the_drive_ends_a_window_and_what_came_before_and_a_stick_the_window()
-> Result<(), Error> {
    let mut supervisor = installed()?;
    let quiet = LoopSample {
        innovation: Some(0.01),
        ..at(100.0)
    };
    supervisor.enter(State::Adapting);
    for _ in 0..=supervisor.design.look {
        assert_eq!(supervisor.update(&quiet), Event::None);
    }
    assert_eq!(supervisor.submit(&certain(OTHER)), Event::None);
    assert_eq!(supervisor.update(&quiet), Event::None);
    assert!(supervisor.running().is_some());
    let sticks = LoopSample {
        sticks: true,
        ..quiet
    };
    assert_eq!(supervisor.update(&sticks), Event::None);
    assert_eq!(supervisor.comparison, Comparison::Rests);
    assert_eq!(supervisor.evidence.challenger(), Some(OTHER));
    assert_eq!(supervisor.submit(&certain(OTHER)), Event::None);
    let changed = LoopSample {
        innovation: Some(1.0),
        ..quiet
    };
    assert_eq!(supervisor.update(&changed), Event::Changed);
    assert_eq!(supervisor.comparison, Comparison::Rests);
    assert_eq!(supervisor.evidence, Evidence::NONE);
    assert_eq!(supervisor.state(), State::Adapting);
    assert_eq!(supervisor.verified_model(), Some(MODEL));
    Ok(())
}

#[test]
fn a_change_right_after_the_state_began_is_its_transient() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let sample = |innovation| LoopSample {
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
fn the_largest_error_is_remembered_and_forgotten() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    let sample = |error| LoopSample { error, ..at(100.0) };
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

#[test]
fn the_first_look_at_an_estimate_is_behind_the_first_moments() -> Result<(), Error> {
    let mut supervisor = installed()?;
    let look = supervisor.design.look;
    for (rejection, first) in [(look - 2, look), (3 * look - 2, 3 * look - 1)] {
        supervisor.design.rejection = rejection;
        supervisor.enter(State::Adapting);
        let samples = (1..5 * look).find(|_| {
            let _ = supervisor.update(&at(100.0));
            supervisor.looks()
        });
        assert_eq!(samples, Some(first));
    }
    Ok(())
}
