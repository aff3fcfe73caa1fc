//! The random levels on drives of all kinds, and by what they are drawn.

mod turns;

use super::*;

const STEP: f32 = 1e-3;
const LIMIT: f32 = 0.6;

/// A drive with its own frequency, damping, gain, dead zone and friction, in travels.
struct Drive {
    w: f32,
    damping: f32,
    gain: f32,
    dead_zone: f32,
    at: [f32; 3],
}

impl Drive {
    fn step(&mut self, command: f32) {
        let flow = command - command.clamp(-self.dead_zone, self.dead_zone);
        for _ in 0..4 {
            let [x, v, a] = self.at;
            let t = 0.25 * STEP;
            let jerk = self.w * self.w * (self.gain * flow - v) - 2.0 * self.damping * self.w * a;
            self.at = [x + t * v, v + t * (a + t * jerk), a + t * jerk];
        }
    }
}

/// Lowest and highest place, and reversals of the command, of a sweep of 6 s.
fn swept(sweep: &mut Sweep, drive: &mut Drive) -> ([f32; 2], u32) {
    let (mut range, mut reversals, mut last) = ([f32::INFINITY, f32::NEG_INFINITY], 0, 0.0_f32);
    for _ in 0..6000 {
        let [x, v, a] = drive.at;
        let command = sweep.update(x, v, a, STEP);
        assert!(command.abs() <= LIMIT + 1e-6, "{command}");
        reversals += u32::from(command * last < 0.0);
        last = command;
        drive.step(command);
        range = [range[0].min(x), range[1].max(x)];
        sweep.pushes([0.1; 2]);
        sweep.take(Standing::Moved);
    }
    (range, reversals)
}

#[test]
fn an_axis_stays_within_its_travel_and_moves_within_the_band() {
    for (k, w) in [8.0_f32, 15.0, 30.0, 60.0].into_iter().enumerate() {
        for damping in [0.2, 0.6, 1.0] {
            for gain in [0.6, 2.0, 5.0] {
                for place in [0.1, 0.5, 0.85] {
                    let half = core::f32::consts::PI / w;
                    let mut sweep = Sweep::new(place, half, 0.03, LIMIT, k as u32);
                    let mut drive = Drive {
                        w,
                        damping,
                        gain,
                        dead_zone: 0.03,
                        at: [place, 0.0, 0.0],
                    };
                    let ([low, high], reversals) = swept(&mut sweep, &mut drive);
                    assert!(
                        low > 0.0 && high < 1.0,
                        "{w} {damping} {gain} {place}: {low} {high}"
                    );
                    // It moves to and fro, about a place that is not near an end.
                    assert!(
                        high - low > 0.03,
                        "{w} {damping} {gain} {place}: {low} {high}"
                    );
                    assert!(reversals > 5, "{w} {damping} {gain} {place}: {reversals}");
                    assert!((MIDDLE[0]..=MIDDLE[1]).contains(&sweep.middle));
                }
            }
        }
    }
}

#[test]
fn draws_are_even_and_differ_between_attempts() {
    let mut first = [0.0; 2];
    for (attempt, first) in first.iter_mut().enumerate() {
        let mut sweep = Sweep::new(0.5, 0.1, 0.02, LIMIT, attempt as u32);
        let mut counts = [0; 10];
        *first = sweep.draw();
        for _ in 0..10_000 {
            let x = sweep.draw();
            assert!((0.0..1.0).contains(&x), "{x}");
            counts[(10.0 * x) as usize] += 1;
        }
        assert!(
            counts.iter().all(|count| (850..1150).contains(count)),
            "{counts:?}"
        );
    }
    assert_ne!(first[0], first[1]);
}

#[test]
fn a_level_is_a_flow_beyond_the_dead_zone_for_some_of_half_a_period() {
    let mut sweep = Sweep::new(0.5, 0.2, 0.05, LIMIT, 0);
    sweep.offset = 0.02;
    let (mut levels, mut times) = ([f32::INFINITY, 0.0_f32], [f32::INFINITY, 0.0_f32]);
    for k in 0..2000 {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        sweep.next(sign, 0.0);
        let size = sign * (sweep.level + 0.02);
        levels = [levels[0].min(size), levels[1].max(size)];
        times = [times[0].min(sweep.left), times[1].max(sweep.left)];
        assert!(sweep.stays);
    }
    // 0.05 at least beyond the dead zone; from 0.35 to 1.5 of the amplitude less 0.6 of it.
    let flow = AMPLITUDE[1] - 0.03;
    let [low, high] = [0.05 + (0.35 * flow).max(0.05), 0.05 + 1.5 * flow];
    assert!(
        (levels[0] - low).abs() < 2e-3 && (levels[1] - high).abs() < 2e-3,
        "{levels:?}"
    );
    assert!(
        (times[0] - 0.04).abs() < 1e-3 && (times[1] - 0.18).abs() < 1e-3,
        "{times:?}"
    );
    // At least as large as asked for, at most the limit.
    sweep.next(-1.0, 0.45);
    assert!((sweep.level + 0.47).abs() < 1e-6);
    for (sign, level) in [(1.0, LIMIT), (-1.0, -LIMIT)] {
        sweep.next(sign, 2.0);
        assert_eq!(sweep.level, level);
    }
    // An axis that stays is pushed by what moves it, where a direction is used up by the other one.
    sweep.pushes([0.5, 0.4]);
    sweep.take(Standing::Exhausted);
    assert!(
        sweep.level > 0.0 && (sweep.level - 0.48).abs() < 1e-6,
        "{}",
        sweep.level
    );
    assert!(sweep.tests && sweep.stays);
    sweep.pushes([0.5, 0.4]);
    sweep.take(Standing::Exhausted);
    assert!((sweep.level + 0.42).abs() < 1e-6, "{}", sweep.level);
    sweep.pushes([0.5, 0.4]);
    sweep.take(Standing::Moved);
    assert!(!sweep.tests && !sweep.stays);
}

#[test]
fn the_amplitude_follows_the_movement_within_two_half_periods() {
    // Positions between two places, a look every 0.4 s.
    let looked = |moved: f32, looks: usize| {
        let mut sweep = Sweep::new(0.5, 0.2, 0.02, LIMIT, 0);
        for k in 0..looks * 401 + 2 {
            let y = 0.5 + if (k / 50) % 2 == 0 { 0.0 } else { moved };
            sweep.look(y, STEP);
        }
        sweep.amplitude
    };
    for (moved, once, always) in [
        (0.02, 1.4 * 0.2, 0.4),
        (0.05, 0.2, 0.2),
        (0.12, 0.8 * 0.2, 0.07),
        (-0.12, 0.8 * 0.2, 0.07),
    ] {
        assert!((looked(moved, 1) - once).abs() < 1e-6, "{moved}");
        assert!((looked(moved, 12) - always).abs() < 1e-6, "{moved}");
    }
}

#[test]
fn a_swing_that_reaches_from_the_band_to_the_end_has_to_fade() {
    // 10 rad/s: per frequency 0.1 s.
    let half = 0.1 * core::f32::consts::PI;
    let fresh = Sweep::new(0.5, half, 0.02, LIMIT, 0);
    let swing = MIDDLE[0] - BAND;
    for (v, a, calms) in [
        (9.9 * swing, 0.0, false),
        (10.1 * swing, 0.0, true),
        (-10.1 * swing, 0.0, true),
        (0.0, 99.0 * swing, false),
        (0.0, -101.0 * swing, true),
        (7.2 * swing, 72.0 * swing, true),
        (7.0 * swing, 70.0 * swing, false),
    ] {
        let mut sweep = fresh;
        assert_eq!(sweep.swings(0.5, v, a).is_some(), calms, "{v} {a}");
        // To half of it.
        if calms {
            assert!(sweep.swings(0.5, 5.1 * swing, 0.0).is_some());
            assert!(sweep.swings(0.5, 4.9 * swing, 0.0).is_none());
            assert!(sweep.swings(0.5, 9.0 * swing, 0.0).is_none());
        }
    }
    // It is pushed away from an end that it would reach, and from neither where it reaches both.
    let pushed = |y: f32, v: f32, a: f32| fresh.clone().swings(y, v, a);
    assert_eq!(pushed(0.15, 20.0 * swing, 0.0), Some(1.0));
    assert_eq!(pushed(0.85, 20.0 * swing, 0.0), Some(-1.0));
    assert_eq!(pushed(0.5, 12.0 * swing, 0.0), Some(0.0));
    assert_eq!(pushed(0.5, 60.0 * swing, 0.0), Some(0.0));
    // About the place where it would come to rest.
    assert_eq!(pushed(0.2, 11.0 * swing, 30.0), Some(0.0));
    let mut sweep = fresh;
    sweep.offset = 0.01;
    let command = sweep.update(0.15, 20.0 * swing, 0.0, STEP);
    assert!((command - (0.35 * LIMIT - 0.01)).abs() < 1e-6);
    for (y, safe) in [(0.04, false), (0.06, true), (0.94, true), (0.96, false)] {
        assert_eq!(fresh.is_safe(y), safe);
    }
}

#[test]
fn numbers_are_those_of_xorshift() {
    let mut sweep = Sweep::new(0.5, 0.1, 0.03, LIMIT, 0);
    sweep.random = 1;
    // From 1 on (Marsaglia 2003, with 13, 17 and 5).
    for exact in [270_369_u32, 67_634_689, 2_647_435_461, 307_599_695] {
        let found = sweep.draw();
        assert_eq!(sweep.random, exact);
        assert_eq!(found, (exact / 256) as f32 / 16_777_216.0);
    }
}

#[test]
fn an_axis_that_friction_holds_is_pushed_the_same_way_until_it_is_used_up() {
    for attempt in 0..4 {
        let mut sweep = Sweep::new(0.5, 0.1, 0.03, LIMIT, attempt);
        let first = sweep.update(0.5, 0.0, 0.0, STEP);
        for k in 0..4000 {
            sweep.pushes([0.4, 0.5]);
            sweep.take(Standing::HeldByFriction);
            let command = sweep.update(0.5, 0.0, 0.0, STEP);
            assert!(command * first > 0.0, "{attempt} {k}");
            let least = if first > 0.0 { 0.4 } else { 0.5 };
            // A hold takes at most 0.9 of half a period.
            assert!(k < 91 || command.abs() >= least, "{attempt} {k}: {command}");
        }
        sweep.pushes([0.4, 0.5]);
        sweep.take(Standing::Exhausted);
        let command = sweep.update(0.5, 0.0, 0.0, STEP);
        assert!(command * first < 0.0 && command.abs() >= 0.4);
    }
}

#[test]
fn an_axis_beyond_the_band_begins_inwards_but_not_always() {
    for (place, inward) in [(0.03, 1.0), (0.1, 1.0), (0.9, -1.0), (0.97, -1.0)] {
        let inwards = |attempt: &u32| {
            let mut sweep = Sweep::new(place, 0.1, 0.03, LIMIT, *attempt);
            inward * sweep.update(place, 0.0, 0.0, STEP) > 0.0
        };
        let count = (0..400).filter(inwards).count();
        // 0.18 or 0.25 from the middle of a band of 0.15: in 0.95 of the draws. Of 400 these are
        // 380, with a deviation of 4.4.
        assert!((362..=398).contains(&count), "{place}: {count}");
    }
}
