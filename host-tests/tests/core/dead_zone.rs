//! The width of a dead zone, found from any steps that determine it.

use proptest::prelude::*;
use trendid::ValveServo;
use trendid::inputs::DeadZone;
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::plants::valve::StaticValve;
use trendid_host_tests::signals::noise::Condition;

const DT: f32 = 0.001;

/// Steps behind a valve with the dead zone `width`, the smallest `margin` above it, the first two
/// far above it.
#[derive(Debug, Clone)]
struct Steps {
    width: f64,
    margin: f64,
    /// By how much the other steps exceed the smallest one.
    beyond: [f64; 3],
    /// Samples of each level.
    hold: [usize; 4],
    /// Width of the white noise on y in um.
    noise: f64,
    seed: u64,
    memory: f32,
    /// Range of the identifier over the largest command.
    range: f32,
}

impl Steps {
    fn levels(&self) -> [f64; 4] {
        let smallest = self.width + self.margin;
        let [a, b, c] = self.beyond;
        [smallest + a, -(smallest + b), smallest, -(smallest + c)]
    }

    /// u and y for 4 s on the reference servo.
    fn record(&self) -> Vec<(f32, f32)> {
        let levels = self.levels();
        let held = levels.iter().zip(self.hold);
        let command = held.flat_map(|(level, hold)| std::iter::repeat_n(*level, hold));
        let u: Vec<f64> = command
            .collect::<Vec<_>>()
            .into_iter()
            .cycle()
            .take(4000)
            .collect();
        let valve = StaticValve {
            dead_zone: self.width,
            ..StaticValve::IDEAL
        };
        let flow: Vec<f64> = u.iter().map(|u| valve.flow(*u)).collect();
        let y_true = REFERENCE.plant(f64::from(DT)).response(&flow);
        let (y, _) = Condition::white(self.noise).measure(&y_true, self.seed);
        u.iter()
            .zip(y)
            .map(|(u, y)| (*u as f32, y as f32))
            .collect()
    }
}

fn steps() -> impl Strategy<Value = Steps> {
    (
        0.01..0.15,
        0.015..0.05,
        (0.1..0.3, 0.03..0.08, 0.1..0.2),
        prop::array::uniform4(120_usize..200),
        prop::sample::select(vec![0.0, 20.0, 100.0]),
        any::<u64>(),
        prop::sample::select(vec![0.7_f32, 2.0]),
        0.7_f32..1.5,
    )
        .prop_map(
            |(width, margin, beyond, hold, noise, seed, memory, range)| Steps {
                width,
                margin,
                beyond: beyond.into(),
                hold,
                noise,
                seed,
                memory,
                range,
            },
        )
}

/// Width, and errors of C, omega0, xi \[%\] after 4 s, from the width 0; each with its standard
/// deviation.
fn found(steps: &Steps) -> ([f64; 2], [[f64; 2]; 3]) {
    let range = steps.range * steps.levels()[0] as f32;
    let mut servo = ValveServo::new(DT, 20.0, range, 50.0, steps.memory).unwrap();
    let mut valve = DeadZone::new(0.0, 0.2, 300);
    for (u, y) in steps.record() {
        let _ = valve.identify(&mut servo, u, y);
    }
    let [a1, a2, b0, ..] = servo.theta().map(f64::from);
    let model = Servo::from_coefficients(a1, a2, b0);
    let errors = model.map_or([f64::INFINITY; 3], |model| model.error_pct(&REFERENCE));
    let estimate = servo.estimate();
    let reading = estimate.physical();
    let values = [reading.gain, reading.omega0, reading.damping].map(|v| v.unwrap_or(f32::NAN));
    let std = estimate.physical_std().unwrap_or([f32::NAN; 3]);
    let relative = core::array::from_fn(|i| [errors[i], f64::from(100.0 * std[i] / values[i])]);
    ([f64::from(valve.delta()), f64::from(valve.std())], relative)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// The first block shows two levels at the most: whatever width it gives does not stay, not
    /// even above a later command.
    #[test]
    fn the_width_is_found_from_any_steps(steps in steps()) {
        let ([width, std], errors) = found(&steps);
        prop_assert!((width - steps.width).abs() < 5.0 * std, "{width} +- {std}");
        prop_assert!(std < 1e-4, "{std}");
        for [error, std] in errors {
            prop_assert!(error.abs() < 5.0 * std, "{errors:?}");
            prop_assert!(std < 0.15, "{errors:?}");
        }
    }
}
