//! Drawn axes that are stopped on a model which is wrong: the brake must not drive them along.

use trendid::servo::store::Record;
use trendid::servo::{Model, Reason, State};
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;

use crate::machine::{Machine, UNIT_MM};

/// The first seed: none was used to tune anything.
const FIRST: u64 = 240_001;

/// What is wrong with a record.
#[derive(Clone, Copy, Debug)]
enum Wrong {
    Nothing,
    Sign,
    StrongGain,
    WeakGain,
    Slow,
    Quick,
    Late,
}

impl Wrong {
    const ALL: [Self; 7] = [
        Self::Nothing,
        Self::Sign,
        Self::StrongGain,
        Self::WeakGain,
        Self::Slow,
        Self::Quick,
        Self::Late,
    ];

    fn of(self, record: &Record) -> Record {
        let mut wrong = record.clone();
        let m = record.model;
        // The same velocity gain and damping at another natural frequency.
        let scaled = |s: f32| Model {
            a1: s * s * m.a1,
            a2: s * m.a2,
            b0: s * s * m.b0,
            friction: s * s * m.friction,
            ..m
        };
        match self {
            Self::Nothing => {}
            Self::Sign => wrong.sign = -record.sign,
            Self::StrongGain => wrong.model.b0 = 3.0 * m.b0,
            Self::WeakGain => wrong.model.b0 = m.b0 / 3.0,
            Self::Slow => wrong.model = scaled(0.5),
            Self::Quick => wrong.model = scaled(2.0),
            Self::Late => wrong.delay = (record.delay + 0.015).min(0.018),
        }
        wrong
    }
}

/// What the stops of many axes came to.
#[derive(Debug, Default)]
struct Stops {
    braked: usize,
    /// Stops behind which the axis became faster, by more than a tenth and 20 mm/s.
    faster: usize,
    /// Largest growth of the speed, and hardest blow behind a stop \[mm/s\].
    growth: f64,
    blow: f64,
    blows: usize,
    /// Ways to rest over the speed, in 1/w of the axis.
    ways: Vec<f64>,
}

/// A move on a wrong record until the loop stops it, and the stop.
fn stopped(axis: &AxisDraw, record: &Record, to: f64, seen: &mut Stops) {
    let mut machine = Machine::new(&axis.starting_at(0.5));
    let stroke = axis.stroke_mm();
    if machine.servo.resume(record).is_err() {
        return;
    }
    let speed = |machine: &mut Machine, before: f64| {
        (machine.bench.position_mm() - before) / axis.sample_time
    };
    let mut state = machine.step().state;
    let targets = [to, 1.0 - to, to];
    let mut v = 0.0;
    while machine.bench.time() < 3.0 && state.is_controlling() {
        let k = (machine.bench.time() / axis.sample_time) as usize;
        if k % 400 == 50 {
            let target = targets[(k / 400) % 3] * stroke / UNIT_MM;
            let _ = machine.servo.move_to(target as f32);
        }
        let before = machine.bench.position_mm();
        state = machine.step().state;
        v = speed(&mut machine, before);
    }
    let braked = matches!(
        state,
        State::Failed(Reason::FollowingError | Reason::TravelEnd | Reason::Saturated)
    );
    if !braked {
        return;
    }
    seen.braked += 1;
    machine.bench.blow_mm_s = 0.0;
    let (first, place) = (v.abs(), machine.bench.position_mm());
    let (mut fastest, mut way) = (first, 0.0_f64);
    let end = machine.bench.time() + 1.0;
    while machine.bench.time() < end {
        let before = machine.bench.position_mm();
        let _ = machine.step();
        fastest = fastest.max(speed(&mut machine, before).abs());
        way = way.max((machine.bench.position_mm() - place).abs());
    }
    let [_, w, _] = axis.truth(0.5 * stroke);
    seen.ways.push(way * w / first.max(10.0));
    seen.faster += usize::from(fastest > 1.1 * first + 20.0);
    seen.growth = seen.growth.max(fastest - first);
    seen.blow = seen.blow.max(machine.bench.blow_mm_s);
    seen.blows += usize::from(machine.bench.blow_mm_s > 50.0);
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn a_brake_on_a_wrong_model_does_not_drive_along() {
    for family in Family::ALL {
        let records: Vec<_> = (FIRST..FIRST + 40)
            .filter_map(|seed| {
                let axis = AxisDraw::new(family, true, seed);
                Some((axis, Machine::new(&axis).record()?))
            })
            .collect();
        for wrong in Wrong::ALL {
            let mut seen = Stops::default();
            for (axis, record) in &records {
                for to in [0.8, 0.2] {
                    stopped(axis, &wrong.of(record), to, &mut seen);
                }
            }
            seen.ways.sort_by(f64::total_cmp);
            let median = seen.ways.get(seen.ways.len() / 2).copied();
            println!(
                "{family:?}, {wrong:?}: {} braked, {} faster, by at most {:.0} mm/s; {} blows, at most {:.0} mm/s; way {median:.2?} v/w",
                seen.braked, seen.faster, seen.growth, seen.blows, seen.blow
            );
            if matches!(wrong, Wrong::WeakGain) {
                assert!(
                    2 * seen.faster <= seen.braked.max(4),
                    "{family:?}: {seen:?}"
                );
                assert!(seen.blows <= 3, "{family:?}: {seen:?}");
            }
        }
    }
}
