//! Whole commissionings, from rest to a model, on drives that are their own models.

mod plant;
mod stop;

use super::*;
use crate::servo::commissioning::tests::plant::{COUNT, Plant, STEP, TRAVEL};
use crate::servo::commissioning::verdict::tests::THETA;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

pub(super) fn design() -> CommissioningDesign {
    CommissioningDesign {
        sample_time: STEP,
        travel: TRAVEL,
        resolution: COUNT / 400.0,
        amplitude: 0.5,
        frequency: None,
        delay: 0.0,
        dead_volume: Some(f32::INFINITY),
        excite_time: 0.6,
        time_limit: 10.0,
    }
}

/// How a commissioning ended, after how many samples, and what it did meanwhile.
struct Ended {
    progress: Progress,
    samples: u32,
    largest: f32,
    range: [f32; 2],
    waited: u32,
    busy: u32,
}

fn commissioned(design: CommissioningDesign, plant: &mut Plant, sign: Option<f32>) -> Ended {
    let limit = (1.1 * design.time_limit / STEP) as u32;
    let mut commissioning = Commissioning::new(design);
    let (y, _) = plant.read();
    commissioning.begin(y, sign);
    let mut ended = Ended {
        progress: Progress::Command(0.0),
        samples: 0,
        largest: 0.0,
        range: [plant.motion.position; 2],
        waited: 0,
        busy: 0,
    };
    while ended.samples < limit {
        ended.samples += 1;
        let (y, same) = plant.read();
        let progress = commissioning.update(y, same);
        let Progress::Command(command) = progress else {
            ended.progress = progress;
            break;
        };
        ended.waited += u32::from(commissioning.candidate().is_some());
        ended.busy += u32::from(commissioning.is_busy());
        // Only an axis that obeys is identified.
        assert!(commissioning.is_sweeping() || !commissioning.is_busy());
        ended.largest = ended.largest.max(command.abs());
        commissioning.applied(y, command);
        plant.step(command);
        let [low, high] = &mut ended.range;
        *low = low.min(plant.motion.position);
        *high = high.max(plant.motion.position);
    }
    ended
}

#[test]
fn a_stated_dead_volume_stays_as_it_is() {
    // Of a very small one no fit goes so far.
    for stated in [0.005, 0.01, 0.1, f32::INFINITY] {
        let mut design = design();
        design.dead_volume = Some(stated);
        let found = Commissioning::new(design).found(&THETA);
        assert_eq!(found.dead_volume, stated);
    }
}

#[test]
fn drives_are_found_from_rest_whatever_their_sign_and_delay() {
    for (w, damping, gain, dead_zone, offset, sign, delay) in [
        (20.0, 0.4, 1000.0, 0.0, 0.0, 1.0, 0),
        (30.0, 0.7, 1500.0, 0.04, 0.01, -1.0, 3),
        (12.0, 0.5, 800.0, 0.02, -0.02, 1.0, 5),
    ] {
        let model = Model {
            dead_zone,
            offset,
            ..Model::linear(w * w, 2.0 * damping * w, gain * w * w)
        };
        let mut plant = Plant::new(model, sign, delay);
        let ended = commissioned(design(), &mut plant, None);
        let Progress::Found(found, command) = ended.progress else {
            panic!("{w}: {:?} after {}", ended.progress, ended.samples);
        };
        assert_eq!(found.sign, sign, "{w}");
        let near = |found: f32, exact: f32, error: f32, what: &str| {
            assert!(
                (found / exact - 1.0).abs() < error,
                "{w} {what}: {found} {exact}"
            );
        };
        near(found.model.a1, model.a1, 0.03, "a1");
        near(found.model.a2, model.a2, 0.05, "a2");
        near(found.model.b0 / found.model.a1, gain, 0.05, "gain");
        assert!(
            (found.model.dead_zone - dead_zone).abs() < 8e-3,
            "{w}: {found:?}"
        );
        assert!((found.model.offset - offset).abs() < 4e-3, "{w}: {found:?}");
        // To a thirtieth of the time scale of the drive.
        let error = found.delay - STEP * delay as f32;
        assert!(error.abs() < 0.033 / w, "{w}: {found:?}");
        assert_eq!(found.dead_volume, f32::INFINITY);
        // Uniform noise of 0.002, and of the rounding.
        assert!(
            (0.8e-3..2e-3).contains(&found.noise),
            "{w}: {}",
            found.noise
        );
        assert!(ended.largest <= 0.5 && command.abs() <= 0.5);
        // It stays well within the travel, and takes some seconds at most.
        let [low, high] = ended.range;
        assert!(
            low > 120.0 && high < 480.0 && high - low > 20.0,
            "{low} {high}"
        );
        assert!(
            (800..8000).contains(&ended.samples),
            "{w}: {}",
            ended.samples
        );
        assert!(ended.waited > 0 && ended.busy > 0);
    }
}

#[test]
fn an_axis_on_a_stop_comes_off_it_without_a_blow() {
    for (w, damping, gain) in [
        (20.0, 0.4, 1000.0),
        (60.0, 0.1, 1500.0),
        (30.0, 0.7, 1500.0),
    ] {
        let model = Model::linear(w * w, 2.0 * damping * w, gain * w * w);
        for end in [TRAVEL.min, TRAVEL.max] {
            for sign in [1.0, -1.0] {
                let mut plant = Plant::new(model, sign, 1);
                plant.motion = Motion::at(end);
                let ended = commissioned(design(), &mut plant, None);
                let Progress::Found(found, _) = ended.progress else {
                    panic!("{w} {end}: {:?}", ended.progress);
                };
                assert_eq!(found.sign, sign, "{w} {end}");
                assert!(plant.blow < 5.0, "{w} {end} {sign}: {}", plant.blow);
            }
        }
    }
}

#[test]
fn what_is_no_drive_is_refused_with_its_reason() {
    let model = Model::linear(400.0, 16.0, 4e5);
    let failed = |plant: &mut Plant, sign| match commissioned(design(), plant, sign).progress {
        Progress::Failed(reason) => Some(reason),
        _ => None,
    };
    // The other sign than the one that is known; the same is none.
    assert_eq!(
        failed(&mut Plant::new(model, 1.0, 1), Some(-1.0)),
        Some(Reason::WrongSign)
    );
    assert_eq!(failed(&mut Plant::new(model, 1.0, 1), Some(1.0)), None);
    assert_eq!(failed(&mut Plant::new(model, -1.0, 1), Some(-1.0)), None);
    let mut blocked = Plant::new(model, 1.0, 1);
    blocked.walls = [280.0; 2];
    assert_eq!(failed(&mut blocked, None), Some(Reason::Blocked));
    let mut deaf = Plant::new(model, 1.0, 1);
    deaf.is_deaf = true;
    assert_eq!(failed(&mut deaf, None), Some(Reason::SensorStuck));
    // A valve that no command moves, and that is open.
    let mut open = Plant::new(
        Model {
            offset: 0.2,
            ..Model::linear(400.0, 16.0, 4e5)
        },
        1.0,
        1,
    );
    open.sign = 0.0;
    let reason = failed(&mut open, None);
    assert!(
        matches!(reason, Some(Reason::ValveStuck | Reason::TravelEnd)),
        "{reason:?}"
    );
}

/// Why a commissioning ends in which something breaks in the `breaks`th sample of random levels,
/// and how many samples later.
fn broken(model: Model, breaks: u32, fault: impl Fn(&mut Plant, f32)) -> Option<(Reason, u32)> {
    let mut plant = Plant::new(model, 1.0, 1);
    let mut commissioning = Commissioning::new(design());
    let (y, _) = plant.read();
    commissioning.begin(y, None);
    let mut swept = 0;
    for _ in 0..12_000 {
        let (y, same) = plant.read();
        let command = match commissioning.update(y, same) {
            Progress::Command(command) => command,
            Progress::Failed(reason) => return Some((reason, swept - breaks)),
            Progress::Found(..) => return None,
        };
        commissioning.applied(y, command);
        plant.step(command);
        swept += u32::from(commissioning.is_sweeping() || swept > 0);
        if swept == breaks {
            fault(&mut plant, command);
        }
    }
    None
}

#[test]
fn an_axis_that_goes_its_own_way_is_noticed_while_levels_are_drawn() {
    for (w, damping) in [(20.0, 0.4), (40.0, 0.15), (12.0, 0.7)] {
        let model = Model::linear(w * w, 2.0 * damping * w, 1000.0 * w * w);
        for breaks in [50, 150, 300] {
            let reversed = broken(model, breaks, |plant, _| plant.sign = -1.0);
            let (reason, samples) = reversed.expect("a reason");
            assert_eq!(reason, Reason::WrongSign, "{w} {breaks}");
            assert!(samples < 3000, "{w} {breaks}: {samples}");
            let stuck = broken(model, breaks, |plant, last| plant.stuck = Some(last));
            let (reason, samples) = stuck.expect("a reason");
            // At an end of the travel it is as good as blocked.
            assert!(
                matches!(reason, Reason::ValveStuck | Reason::Blocked),
                "{w} {breaks}: {reason:?}"
            );
            assert!(samples < 3000, "{w} {breaks}: {samples}");
        }
    }
}

#[test]
fn time_is_limited() {
    for limit in [0.5, 1.0] {
        let mut design = design();
        design.time_limit = limit;
        let mut plant = Plant::new(Model::linear(400.0, 16.0, 4e5), 1.0, 1);
        let ended = commissioned(design, &mut plant, None);
        assert_eq!(ended.progress, Progress::Failed(Reason::Uncertain));
        assert!(
            (ended.samples as f32 * STEP - limit).abs() < 2.1e-3,
            "{}",
            ended.samples
        );
    }
}

#[test]
fn positions_are_shares_of_the_travel() {
    let mut commissioning = Commissioning::new(design());
    for (position, share) in [(100.0, 0.0), (500.0, 1.0), (200.0, 0.25)] {
        assert_eq!(commissioning.share(position), share);
        commissioning.begin(position, None);
        let motion = commissioning.motion();
        assert!((motion.position - position).abs() < 1e-3);
        assert_eq!((motion.velocity, motion.acceleration), (0.0, 0.0));
    }
    assert!(!commissioning.is_sweeping() && !commissioning.is_busy());
    assert_eq!(commissioning.candidate(), None);
    // The filter of the positions is as quick as the drive, and no quicker than samples allow.
    for (frequency, step, rate) in [
        (0.0, 1e-3, 120.0),
        (20.0, 1e-3, 120.0),
        (50.0, 1e-3, 200.0),
        (90.0, 1e-3, 300.0),
        (0.0, 1e-2, 30.0),
    ] {
        assert!((tracking_rate(frequency, step) / rate - 1.0).abs() < 1e-5);
    }
    // A ramp is followed in units of y.
    commissioning.begin(200.0, None);
    for k in 0..400 {
        let _ = commissioning.update(200.0 + 0.05 * k as f32, false);
    }
    let motion = commissioning.motion();
    assert!((motion.velocity / 50.0 - 1.0).abs() < 1e-2, "{motion:?}");
    assert!((motion.position - 219.95).abs() < 0.1, "{motion:?}");
}
