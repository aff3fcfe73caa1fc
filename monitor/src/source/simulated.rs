//! An axis of the population under a loop, with a station on its wire.

use trendid::ConfigError;
use trendid::hardware::{Axis, Scale};
use trendid::servo::store::Record;
use trendid::servo::{Config, Error, ServoLoop};
use trendid_host_tests::plants::pneumatic::AxisParameters;
use trendid_host_tests::servo::population::adaptive::stated;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::{AxisDraw, Mechanics};
use trendid_host_tests::servo::population::range::Purpose;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve};
use trendid_link::telemetry::{
    Event, Health, Identity, Learned, Machine, Refusal, Request, Sample, SettingValue, Station,
    Trick, operate, settings, text,
};

type Loop = ServoLoop<SimulatedSensor, SimulatedValve>;

/// A simulated machine on its wire.
pub(crate) struct Simulated {
    plant: Plant,
    station: Station,
    tick: u32,
}

/// The axis with its loop.
struct Plant {
    bench: Bench,
    servo: Loop,
    config: Config,
    sensor: Axis,
    trick: Trick,
    /// Whether the setpoint of the newest sample stands still.
    rests: bool,
    /// The code that a frozen sensor shows.
    code: i32,
    stored: Option<Record>,
    /// Values of the table that were asked for.
    told: Vec<SettingValue>,
}

/// Units in which the positions are stated, in mm: in the second one accelerations of any axis are
/// within what the loop takes.
const UNITS: [(f64, &str); 2] = [(1.0, "mm"), (100.0, "dm")];

impl Simulated {
    /// The axis of a draw at rest, its loop idle.
    ///
    /// # Errors
    /// What the loop says to the settings.
    pub(crate) fn new(axis: &AxisDraw, name: &str, start: u16) -> Result<Self, Error> {
        let [usual, larger] = UNITS;
        Self::in_unit(axis, name, start, usual)
            .or_else(|_| Self::in_unit(axis, name, start, larger))
    }

    fn in_unit(
        axis: &AxisDraw,
        name: &str,
        start: u16,
        (unit_mm, unit): (f64, &str),
    ) -> Result<Self, Error> {
        let config = stated(axis, unit_mm);
        let (servo, sensor) = build(axis, &config, unit_mm)?;
        let identity = Identity {
            name: text(name),
            unit: unit.try_into().unwrap_or_default(),
            sample_time: config.sample_time,
            travel: [config.travel.min, config.travel.max],
            simulated: true,
        };
        let plant = Plant {
            bench: Bench::new(axis, Purpose::Disturbance),
            servo,
            config,
            sensor,
            trick: Trick::Heal,
            rests: true,
            code: 0,
            stored: None,
            told: Vec::new(),
        };
        let mut station = Station::new(identity, start, 0);
        station.event(Event::Start {
            cause: text("start of the simulation"),
            starts: 1,
        });
        Ok(Self {
            plant,
            station,
            tick: 0,
        })
    }

    /// Bytes that came over the wire.
    pub(crate) fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if let Some(request) = self.station.push(byte) {
                let done = self.plant.operate(&request);
                self.station.answer(done.into());
                for value in self.plant.told.drain(..) {
                    self.station.setting(value);
                }
            }
        }
    }

    /// One sample.
    pub(crate) fn step(&mut self) {
        self.tick = self.tick.wrapping_add(1);
        let (tick, plant) = (self.tick, &mut self.plant);
        plant.servo.sensor_mut().code = plant.reading();
        let report = plant.servo.update();
        plant.rests = report.setpoint.is_rest();
        plant.bench.hold(plant.opening(report.command));
        let wanted = self.station.sample(Sample::of(tick, &report, &plant.servo));
        if wanted.stop {
            plant.servo.abort();
        }
        if report.retuned {
            let model = Learned::of(tick, &report, &plant.servo).model;
            self.station.event(Event::Model(model));
        }
        if wanted.slow {
            self.station
                .learned(Learned::of(tick, &report, &plant.servo));
            self.station.health(Health::of(tick, &report));
        }
    }

    /// Appends what waits for the wire.
    pub(crate) fn send(&mut self, bytes: &mut Vec<u8>) {
        bytes.extend(std::iter::from_fn(|| self.station.next_byte()));
    }
}

impl Plant {
    fn reading(&mut self) -> Option<i32> {
        let code = self.bench.code();
        match self.trick {
            Trick::LoseReadings => None,
            Trick::FreezeSensor => Some(self.code),
            _ => {
                self.code = code;
                Some(code)
            }
        }
    }

    fn opening(&self, command: f32) -> f64 {
        let [_, offset] = self.bench.axis().valve_null();
        match self.trick {
            Trick::CloseValve => -offset,
            _ => f64::from(command),
        }
    }

    fn play(&mut self, trick: Trick) -> Result<(), Refusal> {
        let Mechanics::Pneumatic(nominal) = self.bench.axis().mechanics else {
            if trick == Trick::TripleMass {
                return Err(Refusal::Unsupported);
            }
            self.trick = trick;
            return Ok(());
        };
        let factor = if trick == Trick::TripleMass { 3.0 } else { 1.0 };
        let AxisParameters { mass, load, .. } = nominal;
        if let Some(axis) = self.bench.pneumatic_mut() {
            axis.set_mass(factor * mass);
            axis.set_load(factor * load);
        }
        self.trick = trick;
        Ok(())
    }

    /// Goes over to other settings: at rest, with what was found before.
    fn configure(&mut self, config: Config) -> Result<(), Refusal> {
        let state = self.servo.supervisor().state();
        if state.is_commissioning() || state.is_controlling() && !self.rests {
            return Err(Refusal::Moving);
        }
        let known = self.servo.record();
        let (sensor, valve) = (*self.servo.sensor_mut(), SimulatedValve);
        let mut servo = ServoLoop::try_new(&config, self.sensor, sensor, valve)?;
        if state.is_controlling()
            && let Some(known) = known
        {
            // Before its first sample, which then shows it where the axis is.
            servo.resume(&known)?;
        }
        self.servo = servo;
        self.config = config;
        Ok(())
    }
}

impl Machine for Plant {
    fn operate(&mut self, request: &Request) -> Result<(), Refusal> {
        match *request {
            Request::Set { .. } | Request::Limits { .. } => {
                self.configure(settings::requested(&self.config, request)?)
            }
            Request::Get(setting) => {
                let value = settings::get(&self.config, setting)?;
                self.told.push(SettingValue { setting, value });
                Ok(())
            }
            Request::Store => {
                self.stored = Some(self.servo.record().ok_or(Refusal::NoModel)?);
                Ok(())
            }
            Request::Acknowledge => Ok(()),
            Request::Play(trick) => self.play(trick),
            _ => operate(&mut self.servo, request),
        }
    }
}

fn build(axis: &AxisDraw, config: &Config, unit_mm: f64) -> Result<(Loop, Axis), Error> {
    let resolution = (axis.resolution_mm / unit_mm) as f32;
    let scale = Scale::new(resolution).ok_or(Error::Setting(ConfigError::NotPositive {
        setting: "resolution".into(),
        value: resolution,
    }))?;
    let sensor = Axis {
        scale,
        reference: 0,
    };
    let (code, valve) = (SimulatedSensor::default(), SimulatedValve);
    Ok((ServoLoop::try_new(config, sensor, code, valve)?, sensor))
}
