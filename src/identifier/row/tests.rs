//! What a row counts for, and the noise that is allowed for.

use super::*;
use crate::estimation::rls::Estimator;
use crate::identifier::Outcome;
use crate::identifier::tests::bench::{Drive, config, identifier, trained};
use crate::identifier::witness::Witness;

#[test]
fn a_row_counts_for_what_its_position_is_resolved_to() {
    let row = Row {
        phi: [1.0, -2.0],
        psi: 4.0,
        error: 8.0,
        innovation: 16.0,
    };
    for side in [1.0, -1.0] {
        for (far, weight) in [(0.0, 1.0), (3.0, 1.0), (6.0, 0.5), (12.0, 0.25)] {
            let mut weighed = row;
            weighed.weigh(side * far, 3.0);
            assert_eq!(weighed.phi, [weight, -2.0 * weight]);
            assert_eq!([weighed.psi, weighed.error], [4.0 * weight, 8.0 * weight]);
            // In the unit of y: nothing of the equation.
            assert_eq!(weighed.innovation, 16.0);
        }
    }
}

#[test]
fn noise_is_never_less_than_a_share_of_what_is_expected() {
    let mut level = NoiseLevel::new(1.0);
    let before = Noise::of(&level, 0.5);
    assert_eq!((before.known, before.allowed), (-1.0, 0.5));
    assert_eq!(before.known_or_infinite(), f32::INFINITY);
    // +-1: a variance of 64/20.
    for k in 0..2000 {
        level.update(if k % 2 == 0 { 1.0 } else { -1.0 });
    }
    for (least, allowed) in [(0.5, 3.2), (5.0, 5.0)] {
        let noise = Noise::of(&level, least);
        assert!((noise.known - 3.2).abs() < 0.02);
        assert!((noise.allowed - allowed).abs() < 0.02);
        assert_eq!(noise.known_or_infinite(), noise.allowed);
    }
    let still = Noise {
        known: 0.0,
        allowed: 0.5,
    };
    assert_eq!(still.known_or_infinite(), 0.5);
}

#[test]
fn an_innovation_is_the_part_of_y_that_nothing_explains() {
    // A sample that is larger by 0.001 has an innovation that is larger by that.
    for memory in [None, Some(2.0)] {
        let mut config = config();
        config.memory = memory;
        let (servo, mut drive) = trained(&config, 2000);
        let [u, y] = drive.sample(2001);
        let innovation = |y: f32| {
            let mut other = servo.clone();
            let outcome = other.update(u, y);
            let innovation = outcome.innovation().expect("a prediction");
            assert!((other.prediction() + innovation - y).abs() < 1e-5);
            innovation
        };
        let more = innovation(y + 0.001) - innovation(y);
        assert!((more / 0.001 - 1.0).abs() < 0.02, "{more}");
    }
}

#[test]
fn a_step_of_the_position_enters_where_it_happened() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, drive) = trained(&config, 3000);
    // Far above that of this drive, so that a size is one.
    let noise = 0.05;
    servo.plan.noise.least = noise * noise;
    // Twice the step in the third difference of the second sample, and 4 sqrt(20) are allowed.
    for (size, far) in [(9.5, true), (8.5, false)] {
        let step = size * noise;
        let (mut stepped, mut shifted, mut drive) = (servo.clone(), servo.clone(), drive.clone());
        let [u, y] = drive.sample(3001);
        let first = stepped.update(u, y + step);
        assert!(
            matches!(first, Outcome::Replaced { .. }),
            "{size}: {first:?}"
        );
        assert_eq!(stepped.replaced(), 1);
        let _ = shifted.state.signals.output_trends(&shifted.plan, y + step);
        let [u, y] = drive.sample(3002);
        let second = stepped.update(u, y + step);
        assert!(matches!(second, Outcome::Held { .. }), "{size}: {second:?}");
        assert_eq!(stepped.replaced(), 0);
        // As if both had been taken as measured.
        let reference = stepped.state.signals.reference;
        let _ = shifted
            .state
            .signals
            .output_trends(&shifted.plan, y + step - reference);
        assert_eq!(stepped.state.signals.output, shifted.state.signals.output);
        // What no noise makes is carried by the trends for two over the bandwidth: no row is taken.
        let mut taken = 0;
        for k in 3003..3100 {
            let [u, y] = drive.sample(k);
            let outcome = stepped.update(u, y + step);
            taken += u32::from(matches!(outcome, Outcome::Estimated { .. }));
        }
        assert_eq!(taken == 0, far, "{size}: {taken}");
    }
}

#[test]
fn far_from_zero_rows_are_weighed_by_where_the_drive_is() {
    /// Rows as the estimator takes them.
    #[derive(Default)]
    struct Rows(f32);
    impl<const N: usize> Witness<3, N, 1> for Rows {
        fn begin(&mut self) {}
        fn inputs(&mut self, _: &[[f32; 3]; 1], _: &[f32; 1]) {}
        fn row(&mut self, phi: &[f32; N], _: f32, _: &Estimator<N>, _: bool) {
            self.0 = phi[0];
        }
    }
    for memory in [None, Some(20.0)] {
        let mut config = config();
        (config.memory, config.output_noise) = (memory, 5e-6);
        // Half a digit at 84 is the noise: it begins at 70, and moves by 40.
        let coarse = 5e-6 * 16_777_216.0;
        let (mut near, mut far) = (identifier(&config), identifier(&config));
        let mut drive = Drive::new(1e-4);
        let (mut weighed, mut whole) = (0, 0);
        for k in 0..3000 {
            let [u, y] = drive.sample(k);
            let (mut here, mut there) = (Rows::default(), Rows::default());
            let _ = near.update_seen([u], y, &mut here);
            let _ = far.update_seen([u], 70.0 + y, &mut there);
            if here.0.abs() < 0.1 || there.0 == 0.0 {
                continue;
            }
            let share = |y: f32| (coarse / y.abs()).min(1.0);
            let weight = share(70.0 + y) / share(y);
            let found = there.0 / here.0;
            assert!((found / weight - 1.0).abs() < 0.05, "{k}: {found} {weight}");
            weighed += u32::from(weight < 0.9);
            whole += u32::from(weight == 1.0);
        }
        assert!(weighed > 100 && whole > 100, "{weighed} {whole}");
    }
}
