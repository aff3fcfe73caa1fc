//! The settings that may be changed over the line: names, units, bounds; one table for both ends.

use trendid::servo::{Config, MotionLimits};

use crate::telemetry::request::{Refusal, Request};
use crate::telemetry::text::text;

/// A setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Its name, that of the field of [`Config`].
    pub name: &'static str,
    /// Its unit; `y` stands for the unit of the position.
    pub unit: &'static str,
    /// The smallest and the largest value.
    pub limits: [f32; 2],
    /// Whether it may follow from the others.
    pub follows: bool,
    get: fn(&Config) -> Option<f32>,
    set: fn(&mut Config, Option<f32>),
}

/// A setting that always has a value.
macro_rules! always {
    ($name:literal, $unit:literal, $low:expr, $high:expr, $($field:tt)+) => {
        Setting {
            name: $name, unit: $unit, limits: [$low, $high], follows: false,
            get: |config| Some(config.$($field)+),
            set: |config, value| if let Some(value) = value { config.$($field)+ = value },
        }
    };
}

/// A setting that follows from the others unless it is set.
macro_rules! follows {
    ($name:literal, $unit:literal, $low:expr, $high:expr, $($field:tt)+) => {
        Setting {
            name: $name, unit: $unit, limits: [$low, $high], follows: true,
            get: |config| config.$($field)+,
            set: |config, value| config.$($field)+ = value,
        }
    };
}

/// All of them; a place in the table is the number on the wire.
pub static SETTINGS: [Setting; 18] = [
    follows!("bandwidth", "rad/s", 0.1, 1000.0, bandwidth),
    follows!(
        "controller.bandwidth",
        "rad/s",
        0.1,
        2000.0,
        controller.bandwidth
    ),
    always!(
        "controller.blend",
        "of the valve",
        1e-4,
        0.1,
        controller.blend
    ),
    follows!(
        "controller.rest_window",
        "y",
        0.0,
        1e3,
        controller.rest_window
    ),
    always!(
        "controller.transition",
        "s",
        0.005,
        10.0,
        controller.transition
    ),
    always!("range", "of the valve", 0.01, 1.0, range),
    always!("rate", "1/s", 1.0, 1e5, rate),
    always!("delay", "s", 0.0, 0.1, delay),
    always!("memory", "s", 0.05, 1e3, memory),
    always!("min_excitation", "of the valve", 0.0, 1.0, min_excitation),
    always!(
        "excitation.amplitude",
        "of the valve",
        0.01,
        1.0,
        excitation.amplitude
    ),
    always!(
        "supervision.frequency_factor",
        "",
        1.01,
        100.0,
        supervision.frequency_factor
    ),
    always!(
        "supervision.min_r_squared_adapting",
        "",
        0.0,
        1.0,
        supervision.min_r_squared_adapting
    ),
    always!(
        "supervision.replace_ratio",
        "",
        0.0,
        1.0,
        supervision.replace_ratio
    ),
    always!(
        "supervision.excite_time",
        "s",
        0.01,
        60.0,
        supervision.excite_time
    ),
    follows!(
        "supervision.validation_time",
        "s",
        0.01,
        10.0,
        supervision.validation_time
    ),
    always!(
        "supervision.time_limit",
        "s",
        0.1,
        600.0,
        supervision.time_limit
    ),
    follows!("noise", "y", 0.0, 1e3, noise),
];

/// The value of a setting; `None` when it follows from the others.
///
/// # Errors
/// [`Refusal::Unsupported`] for a number that is not in the table.
pub fn get(config: &Config, setting: u8) -> Result<Option<f32>, Refusal> {
    let setting = SETTINGS
        .get(usize::from(setting))
        .ok_or(Refusal::Unsupported)?;
    Ok((setting.get)(config))
}

/// The settings as a request changes them, checked all together.
///
/// # Errors
/// A [`Refusal`] that names the setting and its limits; [`Refusal::Unsupported`] for a request that
/// changes no settings.
pub fn requested(config: &Config, request: &Request) -> Result<Config, Refusal> {
    let mut changed = config.clone();
    match *request {
        Request::Set { setting, value } => set(&mut changed, setting, value)?,
        Request::Limits {
            velocity,
            acceleration,
            jerk,
        } => {
            changed.motion = Some(MotionLimits {
                velocity,
                acceleration,
                jerk,
            });
        }
        _ => return Err(Refusal::Unsupported),
    }
    changed.resolve()?;
    Ok(changed)
}

/// Changes one value, within its limits.
fn set(config: &mut Config, setting: u8, value: Option<f32>) -> Result<(), Refusal> {
    let setting = SETTINGS
        .get(usize::from(setting))
        .ok_or(Refusal::Unsupported)?;
    let [low, high] = setting.limits;
    let fits = match value {
        None => setting.follows,
        Some(value) => value >= low && value <= high,
    };
    if !fits {
        return Err(Refusal::Value {
            name: text(setting.name),
            value: value.filter(|value| value.is_finite()).unwrap_or(0.0),
            limits: setting.limits,
        });
    }
    (setting.set)(config, value);
    Ok(())
}
