//! The simulated pneumatic axis of the project, alone and under the adaptive position loop.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, Report, ServoLoop, State, Travel};
use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve};

use crate::refusal::refused;

/// Sample time of the axis \[s\].
const SAMPLE_TIME: f64 = 1e-3;

/// What differs from the axis of the project's figures.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Machine {
    seed: u64,
    mass: Option<f64>,
    load: Option<f64>,
    supply: Option<f64>,
    valve_gain: Option<f64>,
    friction: Option<f64>,
    dead_zone: Option<f64>,
    offset: Option<f64>,
    start: Option<f64>,
}

impl Machine {
    fn build(&self) -> PyResult<PneumaticAxis> {
        let mut parameters = AxisParameters::SERVO;
        let travel = 1e3 * parameters.stroke;
        let set = |name: &str, value: Option<f64>, limits: [f64; 2], place: &mut f64| {
            let Some(value) = value else { return Ok(()) };
            within(name, value, limits)?;
            *place = value;
            PyResult::Ok(())
        };
        set("mass", self.mass, [0.1, 1e3], &mut parameters.mass)?;
        set("load", self.load, [-1e3, 1e3], &mut parameters.load)?;
        set(
            "supply",
            self.supply,
            [1.0, 16.0],
            &mut parameters.supply_bar,
        )?;
        set(
            "valve_gain",
            self.valve_gain,
            [0.05, 2.0],
            &mut parameters.valve_gain,
        )?;
        set(
            "dead_zone",
            self.dead_zone,
            [0.0, 0.5],
            &mut parameters.dead_zone,
        )?;
        set("offset", self.offset, [-0.5, 0.5], &mut parameters.offset)?;
        set("start", self.start, [0.0, travel], &mut parameters.start_mm)?;
        let mut axis = PneumaticAxis::new(&parameters, self.seed);
        if let Some(factor) = self.friction {
            within("friction", factor, [0.0, 10.0])?;
            axis.set_friction_scale(factor);
        }
        Ok(axis)
    }
}

fn within(name: &str, value: f64, [low, high]: [f64; 2]) -> PyResult<()> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(refused(format!(
            "{name} = {value} is not within {low}..={high}"
        )))
    }
}

/// The axis alone under the commands `u`, one per millisecond: measured positions, true positions
/// \[mm\].
#[pyfunction]
#[allow(clippy::type_complexity, reason = "two arrays")]
pub(crate) fn simulate_axis<'py>(
    py: Python<'py>,
    u: PyReadonlyArray1<'py, f64>,
    machine: Machine,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let u = u.as_array();
    for (k, u) in u.iter().enumerate() {
        if !(-1.0..=1.0).contains(u) {
            return Err(refused(format!("u[{k}] = {u} is not within -1..=1")));
        }
    }
    let mut axis = machine.build()?;
    let (measured, position): (Vec<f64>, Vec<f64>) = py.detach(|| {
        u.iter()
            .map(|u| {
                let now = (axis.measure(), axis.position_mm());
                axis.step(*u);
                now
            })
            .unzip()
    });
    Ok((measured.into_pyarray(py), position.into_pyarray(py)))
}

/// The loop on its axis.
#[pyclass(module = "trendid._trendid")]
pub(crate) struct AxisLoop {
    axis: PneumaticAxis,
    servo: ServoLoop<SimulatedSensor, SimulatedValve>,
    samples: u64,
    state: State,
}

/// What a run keeps of each sample.
#[derive(Default)]
struct Log {
    t: Vec<f64>,
    position: Vec<f64>,
    measured: Vec<f32>,
    setpoint: Vec<f32>,
    command: Vec<f32>,
    controlling: Vec<bool>,
    /// Where the state changed, and to what.
    states: Vec<(f64, String)>,
}

#[pymethods]
impl AxisLoop {
    #[new]
    fn new(
        machine: Machine,
        bandwidth: Option<f32>,
        adaptive: bool,
        wanted_bandwidth: Option<f32>,
    ) -> PyResult<Self> {
        let travel = Travel {
            min: 0.0,
            max: (1e3 * AxisParameters::SERVO.stroke) as f32,
        };
        let mut config = match bandwidth {
            Some(bandwidth) => Config::new(SAMPLE_TIME as f32, bandwidth, travel),
            None => Config::minimal(SAMPLE_TIME as f32, travel),
        };
        config.adaptive = adaptive;
        config.controller.bandwidth = wanted_bandwidth;
        let scale = Scale::new(RESOLUTION_MM as f32).ok_or_else(|| refused("no resolution"))?;
        let axis = Axis {
            scale,
            reference: 0,
        };
        let servo = ServoLoop::try_new(&config, axis, SimulatedSensor::default(), SimulatedValve);
        Ok(Self {
            axis: machine.build()?,
            servo: servo.map_err(refused)?,
            samples: 0,
            state: State::Idle,
        })
    }

    fn commission(&mut self) {
        self.servo.commission();
    }

    fn abort(&mut self) {
        self.servo.abort();
    }

    fn move_to(&mut self, target: f32) -> PyResult<()> {
        self.servo.move_to(target).map_err(refused)
    }

    fn oscillate(&mut self, amplitude: f32, frequency: f32) -> PyResult<()> {
        self.servo.oscillate(amplitude, frequency).map_err(refused)
    }

    /// Samples of 1 ms; ends early when the state begins with `until`.
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        samples: u64,
        until: Option<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let log = py.detach(|| {
            let mut log = Log::default();
            for _ in 0..samples {
                self.step(&mut log);
                let reached = until
                    .as_ref()
                    .is_some_and(|until| self.state.to_string().starts_with(until));
                if reached {
                    break;
                }
            }
            log
        });
        let values = PyDict::new(py);
        values.set_item("t", log.t.into_pyarray(py))?;
        values.set_item("position", log.position.into_pyarray(py))?;
        values.set_item("measured", log.measured.into_pyarray(py))?;
        values.set_item("setpoint", log.setpoint.into_pyarray(py))?;
        values.set_item("command", log.command.into_pyarray(py))?;
        values.set_item("controlling", log.controlling.into_pyarray(py))?;
        values.set_item("states", log.states)?;
        Ok(values)
    }

    /// Time of the next sample \[s\].
    #[getter]
    fn time(&self) -> f64 {
        SAMPLE_TIME * self.samples as f64
    }

    #[getter]
    fn state(&self) -> String {
        self.state.to_string()
    }

    #[getter]
    fn is_controlling(&self) -> bool {
        self.state.is_controlling()
    }

    /// True position \[mm\].
    #[getter]
    fn position(&self) -> f64 {
        self.axis.position_mm()
    }

    /// a1, a2, b0, dead zone, offset, friction of the verified model.
    #[getter]
    fn model(&self) -> Option<[f32; 6]> {
        Some(self.servo.supervisor().verified_model()?.fields())
    }

    fn set_mass(&mut self, mass: f64) -> PyResult<()> {
        within("mass", mass, [0.1, 1e3])?;
        self.axis.set_mass(mass);
        Ok(())
    }

    fn set_load(&mut self, load: f64) -> PyResult<()> {
        within("load", load, [-1e3, 1e3])?;
        self.axis.set_load(load);
        Ok(())
    }

    fn set_supply(&mut self, bar: f64) -> PyResult<()> {
        within("supply", bar, [1.0, 16.0])?;
        self.axis.set_supply(bar);
        Ok(())
    }

    fn set_valve_gain(&mut self, gain: f64) -> PyResult<()> {
        within("valve_gain", gain, [0.05, 2.0])?;
        self.axis.set_valve_gain(gain);
        Ok(())
    }

    fn set_friction(&mut self, factor: f64) -> PyResult<()> {
        within("friction", factor, [0.0, 10.0])?;
        self.axis.set_friction_scale(factor);
        Ok(())
    }
}

impl AxisLoop {
    fn step(&mut self, log: &mut Log) {
        self.servo.sensor_mut().code = Some(self.axis.measure_counts());
        let t = SAMPLE_TIME * self.samples as f64;
        let position = self.axis.position_mm();
        let report: Report = self.servo.update();
        if self.samples == 0 || report.state != self.state {
            log.states.push((t, report.state.to_string()));
        }
        self.state = report.state;
        log.t.push(t);
        log.position.push(position);
        log.measured.push(report.position);
        log.setpoint.push(report.setpoint.position);
        log.command.push(report.command);
        log.controlling.push(report.state.is_controlling());
        self.axis.step(f64::from(report.command));
        self.samples += 1;
    }
}
