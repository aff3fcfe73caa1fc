//! The loop behind the line does what the loop itself does.

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, Reason, ServoLoop, State, Travel};
use trendid_link::{Controller, Reply, Request, Sample, Setup, code};

const SETUP: Setup = Setup {
    bandwidth: 25.0,
    travel: [0.0, 400.0],
    mm_per_count: 0.01,
    dead_volume: None,
    adaptive: true,
};

struct Code(Option<i32>);

impl PositionSensor for Code {
    type Error = ();
    fn counts(&mut self) -> Result<i32, ()> {
        self.0.ok_or(())
    }
}

struct Through;

impl Valve for Through {
    type Error = ();
    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        Ok(command)
    }
}

fn direct() -> ServoLoop<Code, Through> {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let axis = Axis {
        scale: Scale::new(0.01).expect("scale"),
        reference: 0,
    };
    let config = servo::Config::new(1e-3, 25.0, travel);
    ServoLoop::try_new(&config, axis, Code(None), Through).expect("settings")
}

fn asked(requests: &[Request]) -> Sample {
    Sample {
        code: Some(20_000),
        requests: requests.iter().copied().collect(),
        ..Sample::default()
    }
}

/// The servo x''' + 20 x'' + 400 x' = 10^6 u at 200 mm, eight small steps a sample.
#[derive(Default)]
struct Drive([f64; 3]);

impl Drive {
    fn code(&mut self, u: f32) -> i32 {
        let time = 0.001 / 8.0;
        for _ in 0..8 {
            let [x, v, a] = self.0;
            let a = a + time * (1e6 * f64::from(u) - 20.0 * a - 400.0 * v);
            let v = v + time * a;
            self.0 = [x + time * v, v, a];
        }
        20_000 + (100.0 * self.0[0]).round() as i32
    }
}

#[test]
fn both_loops_give_the_same_bits_through_commissioning_and_moves() {
    let (mut behind, mut direct, mut drive) = (Controller::new(), direct(), Drive::default());
    let (mut command, mut controlled, mut failed) = (0.0, 0, 0);
    for k in 0..4000 {
        let mut sample = match k {
            0 => asked(&[Request::Reset(SETUP), Request::Commission]),
            2200 => asked(&[Request::MoveTo(250.0)]),
            2900 => asked(&[Request::Oscillate {
                amplitude: 20.0,
                frequency: 1.0,
            }]),
            3900 => asked(&[Request::Abort]),
            _ => asked(&[]),
        };
        // One reading in 300 fails.
        sample.code = (k % 300 != 299).then_some(drive.code(command));
        for request in &sample.requests {
            match *request {
                Request::Reset(_) => {}
                Request::Commission => direct.commission(),
                Request::Abort => direct.abort(),
                Request::MoveTo(target) => direct.move_to(target).expect("a target"),
                Request::Oscillate {
                    amplitude,
                    frequency,
                } => direct.oscillate(amplitude, frequency).expect("a sine"),
            }
        }
        direct.sensor_mut().0 = sample.code;
        let report = direct.update();
        let reply = behind.update(&sample);
        let expected = Reply::of(&report, &direct);
        assert_eq!(reply.fields(), expected.fields(), "sample {k}");
        assert_eq!(reply.command.to_bits(), report.command.to_bits());
        command = reply.command;
        controlled += u32::from(report.state.is_controlling());
        failed += u32::from(sample.code.is_none());
    }
    assert!(controlled > 1500, "in control for {controlled} samples");
    assert_eq!(failed, 13);
    let reply = behind.update(&asked(&[]));
    assert_eq!(
        (reply.state, reply.reason),
        codes_of(direct.supervisor().state())
    );
}

/// The codes as documented, written down here once more.
fn codes_of(state: State) -> (u8, u8) {
    match state {
        State::Idle => (0, 255),
        State::Frozen => (5, 255),
        State::Failed(Reason::SensorFault) => (7, 10),
        State::Failed(Reason::Aborted) => (7, 13),
        other => panic!("{other:?} was not expected"),
    }
}

#[test]
fn three_failed_readings_are_a_fault_with_its_code() {
    let mut behind = Controller::new();
    let mut sample = asked(&[Request::Reset(SETUP), Request::Commission]);
    let mut reply = behind.update(&sample);
    assert_eq!((reply.state, reply.reason), (1, code::NO_REASON));
    sample.requests.clear();
    sample.code = None;
    for _ in 0..3 {
        reply = behind.update(&sample);
    }
    let expected = codes_of(State::Failed(Reason::SensorFault));
    assert_eq!((reply.state, reply.reason), expected);
}

#[test]
fn without_a_setup_or_with_a_bad_one_there_is_no_loop() {
    let mut behind = Controller::new();
    assert_eq!(
        behind.update(&asked(&[Request::Commission])).state,
        code::NO_LOOP
    );
    let bad = [
        Setup {
            mm_per_count: 0.0,
            ..SETUP
        },
        Setup {
            travel: [400.0, 0.0],
            ..SETUP
        },
        Setup {
            bandwidth: f32::NAN,
            ..SETUP
        },
    ];
    for setup in bad {
        assert_eq!(behind.update(&asked(&[Request::Reset(SETUP)])).state, 0);
        let reply = behind.update(&asked(&[Request::Reset(setup), Request::MoveTo(1.0)]));
        assert_eq!((reply.state, reply.command), (code::NO_LOOP, 0.0));
    }
}

#[test]
fn a_reset_forgets_everything() {
    let (mut used, mut fresh) = (Controller::new(), Controller::new());
    let begin = asked(&[Request::Reset(SETUP), Request::Commission]);
    for _ in 0..50 {
        let _ = used.update(&begin);
    }
    assert_eq!(used.update(&begin).fields(), fresh.update(&begin).fields());
}
