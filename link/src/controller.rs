//! The loop on the target, and what it reports: one source for target and host.

use trendid::ConfigError;
use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, Report, ServoLoop, Travel};

use crate::{Counters, Reply, Request, Sample, Setup, code};

/// The sensor behind the line: the code that came with the sample.
#[derive(Clone, Copy, Debug, Default)]
struct LineSensor(Option<i32>);

impl PositionSensor for LineSensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        self.0.ok_or(())
    }
}

/// The valve behind the line: the command goes back with the reply.
#[derive(Clone, Copy, Debug)]
struct LineValve;

impl Valve for LineValve {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        Ok(command)
    }
}

/// The adaptive position loop on the target, behind the line.
///
/// ```
/// use trendid_link::{Controller, Request, Sample, Setup, code};
///
/// let mut controller = Controller::new();
/// let mut sample = Sample { code: Some(20_000), ..Sample::default() };
/// assert_eq!(controller.update(&sample).state, code::NO_LOOP);
/// let setup = Setup { bandwidth: 25.0, travel: [0.0, 400.0], mm_per_count: 0.01, dead_volume: None, adaptive: true };
/// sample.requests.push(Request::Reset(setup)).map_err(|_| "full")?;
/// sample.requests.push(Request::Commission).map_err(|_| "full")?;
/// let reply = controller.update(&sample);
/// assert!(reply.state != code::NO_LOOP && reply.position == 200.0);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Controller {
    servo: Option<ServoLoop<LineSensor, LineValve>>,
}

impl Controller {
    /// A controller that waits for its first [`Request::Reset`].
    #[must_use]
    pub const fn new() -> Self {
        Self { servo: None }
    }

    /// Carries out the requests of a sample, then lets the loop process it; number and counters are
    /// the link's.
    pub fn update(&mut self, sample: &Sample) -> Reply {
        for request in &sample.requests {
            self.ask(request);
        }
        let Some(servo) = &mut self.servo else {
            return Reply::without_loop();
        };
        servo.sensor_mut().0 = sample.code;
        let report = servo.update();
        Reply::of(&report, servo)
    }

    fn ask(&mut self, request: &Request) {
        if let Request::Reset(setup) = request {
            // A set-up that is refused leaves no loop, and the reply says so.
            self.servo = build(setup).ok();
        }
        let Some(servo) = &mut self.servo else { return };
        match *request {
            Request::Reset(_) => {}
            Request::Commission => servo.commission(),
            Request::Abort => servo.abort(),
            // A request that is refused changes nothing: the setpoint of the reply shows it.
            Request::MoveTo(target) => {
                let _ = servo.move_to(target);
            }
            Request::Oscillate {
                amplitude,
                frequency,
            } => {
                let _ = servo.oscillate(amplitude, frequency);
            }
        }
    }
}

fn build(setup: &Setup) -> Result<ServoLoop<LineSensor, LineValve>, servo::Error> {
    let [min, max] = setup.travel;
    let mut config = servo::Config::new(1e-3, setup.bandwidth, Travel { min, max });
    config.adaptive = setup.adaptive;
    config.controller.dead_volume = setup.dead_volume;
    let axis = Axis {
        scale: Scale::new(setup.mm_per_count).ok_or(servo::Error::Setting(
            ConfigError::NotPositive {
                setting: "mm_per_count".into(),
                value: setup.mm_per_count,
            },
        ))?,
        reference: 0,
    };
    ServoLoop::try_new(&config, axis, LineSensor::default(), LineValve)
}

impl Reply {
    /// What `servo` did in the sample of `report`; number and counters are the link's.
    #[must_use]
    pub fn of<S: PositionSensor, V: Valve>(report: &Report, servo: &ServoLoop<S, V>) -> Self {
        let (r, controller) = (report.setpoint, servo.controller());
        let (motion, model) = (controller.motion(), controller.model());
        Self {
            seq: 0,
            state: report.state.code(),
            reason: code::of(report.state.reason()),
            retuned: report.retuned,
            command: report.command,
            position: report.position,
            setpoint: [r.position, r.velocity, r.acceleration, r.jerk],
            innovation: report.innovation,
            motion: [motion.position, motion.velocity, motion.acceleration],
            disturbance: controller.disturbance(),
            model: model.fields(),
            theta: servo.identifier().theta(),
            counters: Counters::default(),
        }
    }

    /// The reply of a target that has no loop: command zero.
    fn without_loop() -> Self {
        Self {
            seq: 0,
            state: code::NO_LOOP,
            reason: code::NO_REASON,
            retuned: false,
            command: 0.0,
            position: 0.0,
            setpoint: [0.0; 4],
            innovation: None,
            motion: [0.0; 3],
            disturbance: 0.0,
            model: [0.0; 6],
            theta: [0.0; 6],
            counters: Counters::default(),
        }
    }
}
