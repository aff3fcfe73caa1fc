//! A loop beside the one of a scenario: it gets the same samples, drives the plant, may fail the
//! sensor and end the run.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Reason, Report, ServoLoop, State};
use trendid_host_tests::servo::figures::Figures;
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{Request, Rig, SimulatedSensor, SimulatedValve};
use trendid_host_tests::servo::run::{Options, loop_config, run, run_with_shadow};
use trendid_host_tests::servo::scenario::Scenario;
use trendid_host_tests::servo::shadow::Shadow;

const OPTIONS: Options = Options::adaptive(11);

/// A second loop of the same settings, here.
struct Twin {
    servo: ServoLoop<SimulatedSensor, SimulatedValve>,
    requests: Vec<Request>,
    samples: u32,
    /// Where the run ends.
    end: u32,
    /// The first sample from which the sensor fails.
    blind: u32,
    differences: u32,
}

impl Twin {
    fn new(end: u32, blind: u32) -> Self {
        let axis = Axis {
            scale: Scale::new(RESOLUTION_MM as f32).expect("scale"),
            reference: 0,
        };
        let sensor = SimulatedSensor::default();
        let servo = ServoLoop::try_new(&loop_config(&OPTIONS), axis, sensor, SimulatedValve);
        Self {
            servo: servo.expect("settings"),
            requests: Vec::new(),
            samples: 0,
            end,
            blind,
            differences: 0,
        }
    }

    fn run(&mut self, scenario: Scenario) -> Figures {
        run_with_shadow(scenario, &OPTIONS, self, &mut |_, _| {})
    }
}

impl Shadow for Twin {
    fn reading(&mut self, code: i32) -> Option<i32> {
        (self.samples < self.blind).then_some(code)
    }

    fn request(&mut self, request: Request) {
        self.requests.push(request);
        request.apply_to(&mut self.servo);
    }

    fn update(&mut self, reading: Option<i32>, report: &Report, _: &Rig) -> Option<f32> {
        self.samples += 1;
        self.servo.sensor_mut().code = reading;
        let own = self.servo.update();
        self.differences += u32::from(own != *report);
        (self.samples < self.end).then_some(own.command)
    }
}

#[test]
fn a_twin_hears_all_and_changes_nothing() {
    for scenario in [Scenario::Mass, Scenario::StuckValve] {
        let mut twin = Twin::new(u32::MAX, u32::MAX);
        let figures = twin.run(scenario);
        assert_eq!(figures, run(scenario, &OPTIONS, &mut |_, _| {}));
        assert_eq!(twin.differences, 0, "{}", scenario.name());
        assert_eq!(twin.requests.first(), Some(&Request::Commission));
        let moves = |r: &&Request| matches!(r, Request::MoveTo(_));
        assert!(twin.requests.iter().filter(moves).count() >= 1);
        let sine = |r: &Request| matches!(r, Request::Oscillate { .. });
        assert!(twin.requests.iter().any(sine));
    }
}

#[test]
fn the_plant_obeys_the_shadow() {
    /// Never opens the valve.
    struct Closed(f32);
    impl Shadow for Closed {
        fn request(&mut self, _: Request) {}
        fn update(&mut self, _: Option<i32>, report: &Report, _: &Rig) -> Option<f32> {
            self.0 = self.0.max((report.position - 200.0).abs());
            Some(0.0)
        }
    }
    let mut closed = Closed(0.0);
    let figures = run_with_shadow(Scenario::Nominal, &OPTIONS, &mut closed, &mut |_, _| {});
    assert_eq!(figures.verified_at_s, None);
    assert!(closed.0 < 0.1, "the axis moved by {} mm", closed.0);
}

#[test]
fn a_run_ends_where_the_shadow_ends_it() {
    let mut twin = Twin::new(2500, u32::MAX);
    let figures = twin.run(Scenario::Nominal);
    assert_eq!(twin.samples, 2500);
    assert!(figures.verified_at_s.is_some_and(|t| t < 2.5));
    assert_eq!(figures.steady_state_mm, None);
}

#[test]
fn readings_that_fail_reach_the_loop() {
    let mut twin = Twin::new(1500, 1000);
    let figures = twin.run(Scenario::Nominal);
    assert_eq!(figures.state, State::Failed(Reason::SensorFault));
    assert_eq!(twin.differences, 0);
}
