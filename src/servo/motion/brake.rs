//! A brake within the travel.
//!
//! From a velocity v no brake needs less than `v^2 / 2 room`. With twice the acceleration and four
//! times the jerk a brake is half as long; limits of motion that are slow for the axis are doubled
//! until the room suffices, and no further.

use crate::servo::motion::profile::Move;
use crate::servo::motion::segment::braking;
use crate::servo::motion::{Motion, MotionLimits, Travel};

/// Doublings that are tried one by one; where more are needed, the first of them are taken at once,
/// but for the last two.
const TRIED: u8 = 6;
const LAST: u8 = 2;
/// Doublings beyond which there is no room.
const MOST: u8 = 30;

/// To rest at the limits, and harder only where the travel ends sooner.
pub(crate) fn brake(from: Motion, limits: &MotionLimits, travel: &Travel) -> Move {
    let mut limits = *limits;
    let needed = doublings(&from, &limits, travel);
    if needed > TRIED {
        limits = harder(&limits, (1_u32 << (needed - LAST)) as f32);
    }
    let mut stop = Move::stop(from, &limits);
    for _ in 0..TRIED {
        if stop.stays_within(travel) {
            break;
        }
        limits = harder(&limits, 2.0);
        stop = Move::stop(from, &limits);
    }
    stop
}

/// So many times the acceleration, with its jerk.
fn harder(limits: &MotionLimits, factor: f32) -> MotionLimits {
    MotionLimits {
        acceleration: factor * limits.acceleration,
        jerk: factor * factor * limits.jerk,
        ..*limits
    }
}

/// How often the acceleration must be doubled for the room to the end ahead. Cost: some 50
/// instructions each.
fn doublings(from: &Motion, limits: &MotionLimits, travel: &Travel) -> u8 {
    let (way, room) = if from.velocity > 0.0 {
        (1.0, travel.max - from.position)
    } else {
        (-1.0, from.position - travel.min)
    };
    let (speed, gains) = (way * from.velocity, (way * from.acceleration).max(0.0));
    let (mut limits, mut count) = (*limits, 0);
    while count < MOST {
        // What it has of acceleration goes first.
        let time = gains / limits.jerk;
        let distance = time * (speed + gains * time * (1.0 / 3.0));
        if distance + braking(speed + 0.5 * gains * time, &limits) <= room {
            break;
        }
        limits = harder(&limits, 2.0);
        count += 1;
    }
    count
}
