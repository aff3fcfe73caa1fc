//! The supervisor over months.

use super::*;
use crate::servo::config::Config;
use crate::servo::error::Error;
use crate::servo::motion::{Motion, Travel};

#[test]
fn after_months_in_one_state_the_estimate_is_looked_at_as_often_as_before() -> Result<(), Error> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let design = Config::new(1e-3, 25.0, travel).resolve()?;
    let mut supervisor = Supervisor::new(&design.supervision);
    assert_eq!(supervisor.install(Model::linear(625.0, 25.0, 1e6)), Ok(()));
    supervisor.enter(State::Adapting);
    supervisor.ticks = u32::MAX - 100;
    let seen = Observation {
        motion: Motion {
            velocity: 100.0,
            ..Motion::default()
        },
        y: 0.0,
        flow: 0.0,
        same_code: false,
        sticks: false,
        error: 10.0,
        innovation: None,
    };
    let mut looks = 0;
    for _ in 0..1600 {
        assert_eq!(supervisor.update(&seen), Event::None);
        looks += u32::from(supervisor.wants_candidate());
    }
    assert_eq!(looks, 100);
    Ok(())
}
