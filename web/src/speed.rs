//! The time of many samples, without the drive: its record is made before.

use trendid::Servo;

/// A record of a drive of 20 rad/s under a square command: u, y.
pub(crate) fn record(samples: u32) -> Vec<[f32; 2]> {
    let (mut y, mut v, mut a) = (0.0_f64, 0.0, 0.0);
    (0..samples)
        .map(|k| {
            let u = if (k / 53) % 2 == 0 { 0.4 } else { -0.4 };
            let now = y as f32;
            for _ in 0..4 {
                let h = 2.5e-4;
                y += h * v;
                v += h * a;
                a += h * (1e6 * u - 400.0 * v - 20.0 * a);
            }
            [u as f32, now]
        })
        .collect()
}

/// The parameter a1 of the record, or NaN for one without samples.
pub(crate) fn identify(record: &[[f32; 2]]) -> f32 {
    let Ok(mut servo) = Servo::<0>::new(1e-3, 20.0, 0.4, 50.0) else {
        return f32::NAN;
    };
    for [u, y] in record {
        let _ = servo.update(*u, *y);
    }
    servo.theta()[0]
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_record_holds_the_drive() {
        let a1 = super::identify(&super::record(20_000));
        assert!((a1 / 400.0 - 1.0).abs() < 0.05, "{a1}");
    }
}
