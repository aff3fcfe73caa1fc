//! The axis as a controller sees it: one command and one measurement per sample of 1 ms.

use crate::random::Random;
use rand::{RngExt, SeedableRng};

use super::dynamics::{Dynamics, State, opening};
use super::flow::resting_pressures;
use super::linear::Linearised;
use super::parameters::AxisParameters;

/// Sampling interval \[s\].
const SAMPLE: f64 = 1e-3;

/// A defect that a supervisor must notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The sensor repeats its last count.
    StuckSensor,
    /// The spool stays where it is.
    StuckValve,
    /// The slide is clamped where it is.
    BlockedAxis,
    /// The valve is connected the wrong way round.
    WrongSign,
}

/// A pneumatic servo axis, advanced sample by sample.
///
/// One sample of a loop is `y = measure()` at t, then `step(u)`, which holds u from t to t + 1 ms.
/// A change at run time or a fault takes effect with the next step.
#[derive(Clone, Debug)]
pub struct PneumaticAxis {
    nominal: AxisParameters,
    parameters: AxisParameters,
    dynamics: Dynamics,
    state: State,
    noise: Random,
    fault: Option<Fault>,
    last_count: i32,
    command: f64,
    time: u64,
}

impl PneumaticAxis {
    /// An axis at rest at its starting position, chambers at the pressure that the leaking valve
    /// settles at.
    ///
    /// # Panics
    /// When a parameter makes no physical sense; the message names it.
    pub fn new(parameters: &AxisParameters, seed: u64) -> Self {
        let p = *parameters;
        if let Some(name) = p.fault() {
            panic!("parameter {name} of the axis makes no sense: {p:?}");
        }
        let [pa, pb] = resting_pressures(&p);
        let state = State {
            x: 1e-3 * p.start_mm,
            v: 0.0,
            pa,
            pb,
            spool: 0.0,
            rate: 0.0,
        };
        let mut axis = Self {
            nominal: p,
            parameters: p,
            dynamics: Dynamics::new(&p),
            state,
            noise: Random::seed_from_u64(seed),
            fault: None,
            last_count: 0,
            command: 0.0,
            time: 0,
        };
        axis.last_count = axis.count();
        axis
    }

    /// Holds the command `u` (limited to -1..1) for 1 ms.
    ///
    /// # Panics
    /// When `u` is not finite.
    pub fn step(&mut self, u: f64) {
        let h = SAMPLE / f64::from(self.parameters.substeps);
        for _ in 0..self.parameters.substeps {
            self.advance(u, h);
        }
        self.time += 1;
    }

    /// Holds the command `u` (limited to -1..1) for `h` seconds, one step of the integrator;
    /// [`PneumaticAxis::time`] counts whole samples only.
    ///
    /// # Panics
    /// When `u` is not finite.
    pub fn advance(&mut self, u: f64, h: f64) {
        assert!(u.is_finite(), "command {u} at sample {}", self.time);
        self.command = u.clamp(-1.0, 1.0);
        let command = match self.fault {
            Some(Fault::WrongSign) => -self.command,
            Some(Fault::StuckValve) => {
                self.state.rate = 0.0;
                self.state.spool
            }
            _ => self.command,
        };
        let blocked = self.fault == Some(Fault::BlockedAxis);
        self.dynamics.advance(&mut self.state, command, h, blocked);
    }

    /// Measures the position \[mm\]: noise, then resolution. Every call draws a new noise.
    pub fn measure(&mut self) -> f64 {
        f64::from(self.measure_counts()) * self.parameters.resolution_mm
    }

    /// Measures the position in counts of the resolution. Every call draws a new noise.
    pub fn measure_counts(&mut self) -> i32 {
        if self.fault != Some(Fault::StuckSensor) {
            self.last_count = self.count();
        }
        self.last_count
    }

    fn count(&mut self) -> i32 {
        let half = self.parameters.sensor_noise_mm;
        let noise = half * (2.0 * self.noise.random::<f64>() - 1.0);
        // A stroke of metres at a resolution of nanometres still fits; `as` saturates beyond.
        ((self.position_mm() + noise) / self.parameters.resolution_mm).round() as i32
    }

    /// True position from the stop on the side of chamber A \[mm\].
    pub fn position_mm(&self) -> f64 {
        1e3 * self.state.x
    }

    /// True velocity \[mm/s\].
    pub fn velocity_mm_s(&self) -> f64 {
        1e3 * self.state.v
    }

    /// Absolute pressures of the chambers A and B \[bar\].
    pub fn pressures_bar(&self) -> [f64; 2] {
        [1e-5 * self.state.pa, 1e-5 * self.state.pb]
    }

    /// Pressure force on the piston \[N\].
    pub fn force(&self) -> f64 {
        self.dynamics.force(&self.state)
    }

    /// Position of the spool in units of the command.
    pub fn spool(&self) -> f64 {
        self.state.spool
    }

    /// Flow opening of the valve: spool and offset beyond the dead zone, times the valve gain.
    pub fn opening(&self) -> f64 {
        opening(&self.parameters, self.state.spool)
    }

    /// The last command after limiting.
    pub fn command(&self) -> f64 {
        self.command
    }

    /// Time since the start \[s\].
    pub fn time(&self) -> f64 {
        SAMPLE * self.time as f64
    }

    /// The parameters as they are now.
    pub fn parameters(&self) -> &AxisParameters {
        &self.parameters
    }

    /// C, omega0 and xi at a position \[mm\] for small motions at a mean opening of the valve, see
    /// [`Linearised`].
    pub fn linearised(&self, position_mm: f64, mean_opening: f64) -> Linearised {
        Linearised::new(&self.parameters, position_mm, mean_opening)
    }

    /// Changes the moving mass \[kg\]; the velocity stays.
    pub fn set_mass(&mut self, mass: f64) {
        self.change(|p, _| p.mass = mass);
    }

    /// Changes the constant force on the mass \[N\]; the pressures stay.
    pub fn set_load(&mut self, load: f64) {
        self.change(|p, _| p.load = load);
    }

    /// Changes the supply pressure \[bar above ambient\].
    pub fn set_supply(&mut self, bar: f64) {
        self.change(|p, _| p.supply_bar = bar);
    }

    /// Changes the factor on the opening of the valve, 1 nominally.
    pub fn set_valve_gain(&mut self, gain: f64) {
        self.change(|p, _| p.valve_gain = gain);
    }

    /// Sets the friction to a multiple of that at construction.
    pub fn set_friction_scale(&mut self, factor: f64) {
        self.change(|p, nominal| p.friction = nominal.friction.scaled(factor));
    }

    /// Changes the half width of the dead zone and the offset of the valve.
    pub fn set_valve_null(&mut self, dead_zone: f64, offset: f64) {
        self.change(|p, _| {
            p.dead_zone = dead_zone;
            p.offset = offset;
        });
    }

    /// Brings a fault, or heals it with `None`. A blocked slide loses its velocity.
    pub fn set_fault(&mut self, fault: Option<Fault>) {
        if fault == Some(Fault::BlockedAxis) {
            self.state.v = 0.0;
        }
        self.fault = fault;
    }

    /// The present fault.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    fn change(&mut self, edit: impl Fn(&mut AxisParameters, &AxisParameters)) {
        edit(&mut self.parameters, &self.nominal);
        if let Some(name) = self.parameters.fault() {
            panic!("changed parameter {name} of the axis makes no sense");
        }
        self.dynamics = Dynamics::new(&self.parameters);
    }
}
