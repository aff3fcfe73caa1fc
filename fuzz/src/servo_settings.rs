//! Settings and models for the position loop, near usual ones or any numbers.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, Model, MotionLimits, Travel};

use crate::bytes::Bytes;

/// Sample time, travel and settings, which the loop accepts or refuses.
pub(crate) fn settings(bytes: &mut Bytes<'_>) -> (Config, Axis) {
    let kind = bytes.byte();
    let (sample_time, length) = if kind & 0x0F == 0 {
        (1e-3 * bytes.decades(2.0), 400.0 * bytes.decades(3.0))
    } else {
        (1e-3, 400.0)
    };
    let min = if kind & 0x10 == 0 {
        0.0
    } else {
        length * bytes.share()
    };
    let travel = Travel {
        min,
        max: min + length,
    };
    let mut config = if kind & 0x20 == 0 {
        Config::minimal(sample_time, travel)
    } else {
        Config::new(sample_time, 20.0 * bytes.decades(1.0), travel)
    };
    if kind & 0x40 != 0 {
        config.adaptive = bytes.byte() & 1 == 0;
        config.reversed = [None, Some(false), Some(true)][usize::from(bytes.choice(3))];
        config.range = bytes.share().abs();
        config.rate = 400.0 * bytes.decades(2.0);
        config.delay = 0.008 * bytes.share().abs();
        config.memory = 1.5 * bytes.decades(1.0);
        config.excitation.amplitude = bytes.share().abs();
        config.noise = (bytes.byte() & 1 == 0).then(|| 1e-3 * length * bytes.decades(3.0));
    }
    if kind & 0x80 != 0 {
        // One setting is any number at all.
        let any = bytes.any();
        let place: &mut f32 = match bytes.choice(12) {
            0 => config.controller.bandwidth.insert(any),
            1 => &mut config.controller.blend,
            2 => config.controller.dead_volume.insert(any),
            3 => &mut config.controller.transition,
            4 => &mut config.supervision.frequency_factor,
            5 => &mut config.supervision.max_relative_std_adapting,
            6 => &mut config.supervision.min_r_squared_adapting,
            7 => &mut config.supervision.replace_ratio,
            8 => &mut config.supervision.excite_time,
            9 => config.supervision.validation_time.insert(any),
            10 => &mut config.supervision.time_limit,
            _ => &mut config.min_excitation,
        };
        *place = any;
        if bytes.byte() & 1 == 0 {
            config.motion = Some(MotionLimits {
                velocity: length * bytes.decades(2.0),
                acceleration: length * bytes.decades(4.0),
                jerk: length * bytes.decades(6.0),
            });
        }
    }
    let axis = Axis {
        scale: Scale::new(length / 80_000.0).expect("a length"),
        reference: 0,
    };
    (config, axis)
}

/// A model near a usual one, or any numbers.
pub(crate) fn model(bytes: &mut Bytes<'_>, length: f32) -> Model {
    let usual = Model::linear(400.0, 20.0, 400.0 * 6.0 * length);
    if bytes.byte() & 1 == 0 {
        return Model {
            a1: usual.a1 * bytes.decades(1.0),
            a2: usual.a2 * bytes.decades(1.0),
            b0: usual.b0 * bytes.decades(1.0),
            dead_zone: 0.1 * bytes.share(),
            offset: 0.1 * bytes.share(),
            friction: 10.0 * length * bytes.share(),
        };
    }
    Model {
        a1: bytes.signal(usual.a1),
        a2: bytes.signal(usual.a2),
        b0: bytes.signal(usual.b0),
        dead_zone: bytes.signal(0.1),
        offset: bytes.signal(0.1),
        friction: bytes.signal(10.0 * length),
    }
}
