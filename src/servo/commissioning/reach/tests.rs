//! Drives that swing, seen through the filter of the commissioning, and drives that obey the other
//! sign.

use super::*;
use crate::servo::commissioning::oracle::Dice;
use crate::servo::commissioning::tracking_rate;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;

const STEP: f32 = 1e-3;
const DETECTION: f32 = 1e-3;

/// A drive of order 3 with a gain of one travel per s, behind the filter of the commissioning.
struct Drive {
    w: f32,
    xi: f32,
    state: [f32; 3],
    filter: AlphaBetaGamma,
    noise: f32,
}

impl Drive {
    fn new(w: f32, xi: f32, state: [f32; 3]) -> Self {
        let mut filter = AlphaBetaGamma::new(tracking_rate(w, STEP), STEP);
        filter.place(state[0]);
        Self {
            w,
            xi,
            state,
            filter,
            noise: 0.0,
        }
    }

    fn step(&mut self, flow: f32, dice: &mut Dice) -> Motion {
        let [mut y, mut v, mut a] = self.state;
        for _ in 0..10 {
            let jerk = self.w * self.w * (flow - v) - 2.0 * self.xi * self.w * a;
            y += 0.1 * STEP * v;
            v += 0.1 * STEP * a;
            a += 0.1 * STEP * jerk;
        }
        self.state = [y, v, a];
        self.filter.update(y + self.noise * dice.roll());
        self.filter.motion()
    }
}

/// How far a drive has gone back when it is out of reach of a swing, while the valve makes `along`
/// times what the command wants.
fn gone_back(drive: &mut Drive, command: f32, along: f32, dice: &mut Dice) -> Option<f32> {
    let mut reach = Reach::default();
    let begin = drive.state[0];
    let deviation = 0.125 * DETECTION * drive.filter.acceleration_noise();
    reach.inform(1.0 / drive.w, deviation, DETECTION);
    (0..2000).find_map(|_| {
        let motion = drive.step(along * command, dice);
        reach
            .update(&motion, command, STEP)
            .then(|| (begin - drive.state[0]) * command.signum())
    })
}

#[test]
fn no_swing_is_out_of_its_reach_whatever_it_begins_with() {
    let mut dice = Dice::new(1);
    for k in 0..400 {
        let w = 8.0 + 82.0 * dice.within(0.0, 1.0);
        let xi = 0.02 + 1.2 * dice.within(0.0, 1.0) * dice.within(0.0, 1.0);
        let start = [0.5, dice.roll(), w * dice.roll()];
        let mut drive = Drive::new(w, xi, start);
        // The filter has seen the motion before, with the valve closed.
        let before = (4.0 * w / tracking_rate(w, STEP) / (w * STEP)) as u32;
        for _ in 0..before.max(100) {
            let _ = drive.step(0.0, &mut dice);
        }
        // Even numbers have a deviation of an eighth of a movement that counts.
        drive.noise = if k % 2 == 0 { 0.2165 * DETECTION } else { 0.0 };
        let command = (0.05 + 0.4 * dice.within(0.0, 1.0)) * dice.roll().signum();
        let gone = gone_back(&mut drive, command, 1.0, &mut dice);
        assert_eq!(gone, None, "{k}: {w} {xi} {start:?} {command}");
    }
}

#[test]
fn noise_that_looks_like_a_swing_beside_a_small_one_is_none() {
    let mut dice = Dice::new(3);
    for k in 0..300 {
        let w = 8.0 + 6.0 * dice.within(0.0, 1.0);
        let size = 0.2 * dice.within(0.0, 1.0);
        let start = [0.5, size * dice.roll(), 0.0];
        let mut drive = Drive::new(w, 0.02 + 0.1 * dice.within(0.0, 1.0), start);
        drive.noise = 0.2165 * DETECTION;
        for _ in 0..(200.0 * dice.within(0.0, 1.0)) as u32 {
            let _ = drive.step(0.0, &mut dice);
        }
        let gone = gone_back(&mut drive, 0.02, 1.0, &mut dice);
        assert_eq!(gone, None, "{k}: {w} {start:?}");
    }
}

#[test]
fn what_goes_back_from_rest_is_found_within_two_hundredths_of_the_travel() {
    let mut dice = Dice::new(2);
    for _ in 0..100 {
        let w = 8.0 + 82.0 * dice.within(0.0, 1.0);
        let mut drive = Drive::new(w, 0.1 + 0.5 * dice.within(0.0, 1.0), [0.5, 0.0, 0.0]);
        drive.noise = 0.05 * DETECTION;
        let command = (0.05 + 0.25 * dice.within(0.0, 1.0)) * dice.roll().signum();
        let gone = gone_back(&mut drive, command, -1.0, &mut dice);
        let gone = gone.expect("it obeys the other sign");
        // Two movements that count, what noise may look like, and the speed until then.
        let noise = 0.125 * DETECTION * drive.filter.acceleration_noise() / (w * w);
        let most = 0.02 + 9.0 * noise;
        assert!((2e-3..most).contains(&gone), "{w} {command}: {gone} {most}");
    }
}

#[test]
fn each_direction_of_the_command_begins_anew_and_none_says_nothing() {
    let mut reach = Reach::default();
    reach.inform(0.02, 0.0, DETECTION);
    let back = |k: u32| Motion::at(0.5 - 1e-4 * k as f32);
    // Twenty samples of the lateness, and then two movements that count.
    let found = (1..100).find(|k| reach.update(&back(*k), 0.2, STEP));
    assert_eq!(found, Some(42));
    let mut again = reach;
    assert!(!reach.update(&back(43), 0.0, STEP));
    assert!((44..64).all(|k| !reach.update(&back(k), 0.2, STEP)));
    assert!((64..200).all(|k| !reach.update(&back(k), -0.2, STEP)));
    again.restart();
    assert!((43..84).all(|k| !again.update(&back(k), 0.2, STEP)));
}

#[test]
fn of_another_time_scale_noise_looks_like_another_swing() {
    let mut one = Reach::default();
    one.inform(0.1, 0.5, DETECTION);
    one.rescale(0.02);
    let mut other = Reach::default();
    other.inform(0.02, 0.5, DETECTION);
    assert_eq!(one.per_frequency, other.per_frequency);
    assert!((one.margin / other.margin - 1.0).abs() < 1e-4);
    let expected = 2.0 * DETECTION + 9.0 * 0.5 * 0.02 * 0.02;
    assert!((other.margin / expected - 1.0).abs() < 1e-5);
}
