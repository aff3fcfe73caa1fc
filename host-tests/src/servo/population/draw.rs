//! One axis of the population: what it is, and what its user knows of it.

use crate::random::Random;
use rand::RngExt;

use crate::plants::pneumatic::{AxisParameters, Friction, Linearised};
use crate::plants::third_order::ThirdOrderParameters;
use crate::plants::valve::StaticValve;
use crate::servo::population::family::{self, Family};
use crate::servo::population::range::{Purpose, Range, stream};

/// Standard acceleration of gravity \[m/s2\].
const GRAVITY: f64 = 9.806_65;

/// The mechanics of an axis with its valve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mechanics {
    /// A pneumatic cylinder.
    Pneumatic(AxisParameters),
    /// A drive of third order.
    ThirdOrder(ThirdOrderParameters),
}

/// Largest derivatives of a move \[mm, s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest velocity.
    pub velocity: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest jerk.
    pub jerk: f64,
}

/// An axis of the population.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisDraw {
    /// Its family.
    pub family: Family,
    /// Its seed.
    pub seed: u64,
    /// Mechanics and valve.
    pub mechanics: Mechanics,
    /// Sample time \[s\].
    pub sample_time: f64,
    /// Dead time \[s\].
    pub dead_time: f64,
    /// Resolution of the sensor \[mm\].
    pub resolution_mm: f64,
    /// Half width of the uniform noise of the sensor \[mm\].
    pub noise_mm: f64,
    /// Whether the valve is connected the wrong way round at first.
    pub reversed: bool,
    /// Jitter of a sampling instant over the sample time.
    pub jitter: f64,
    /// Share of slots in which the loop does not run.
    pub missed: f64,
    /// Rough bandwidth that the user states \[rad/s\].
    pub stated_bandwidth: f64,
}

impl AxisDraw {
    /// The axis of a seed; `usual` draws from the half of each range about an ordinary machine.
    pub fn new(family: Family, usual: bool, seed: u64) -> Self {
        let mut random = stream(seed, Purpose::Axis);
        let mechanics = loop {
            let mechanics = match family {
                Family::Pneumatic | Family::SingleRod => pneumatic(family, usual, &mut random),
                _ => Some(third_order(family, usual, &mut random)),
            };
            if let Some(mechanics) = mechanics {
                break mechanics;
            }
        };
        let [fast, normal, slow] = family::SAMPLE_TIMES;
        let sample_time = match random.random_range(0..3_u32) {
            0 if !usual => fast,
            1 if !usual => slow,
            _ => normal,
        };
        let mut draw = Self {
            family,
            seed,
            mechanics,
            sample_time,
            dead_time: family::DEAD_TIME.draw(usual, &mut random),
            resolution_mm: family::RESOLUTION.draw(usual, &mut random),
            noise_mm: family::NOISE.draw(usual, &mut random),
            reversed: random.random(),
            jitter: family::JITTER.draw(usual, &mut random),
            missed: family::MISSED.draw(usual, &mut random),
            stated_bandwidth: 0.0,
        };
        let [_, omega0, _] = draw.truth(0.5 * draw.stroke_mm());
        let mut known = stream(seed, Purpose::Knowledge);
        draw.stated_bandwidth = omega0 * family::STATED_BANDWIDTH.draw(false, &mut known);
        draw
    }

    /// The same axis with another place at the start, over the travel.
    pub fn starting_at(mut self, share: f64) -> Self {
        let start = share * self.stroke_mm();
        match &mut self.mechanics {
            Mechanics::Pneumatic(p) => p.start_mm = start,
            Mechanics::ThirdOrder(p) => p.start = start,
        }
        self
    }

    /// Travel \[mm\].
    pub fn stroke_mm(&self) -> f64 {
        match &self.mechanics {
            Mechanics::Pneumatic(p) => 1e3 * p.stroke,
            Mechanics::ThirdOrder(p) => p.stroke,
        }
    }

    /// Velocity gain \[mm/s\], natural frequency \[rad/s\] and damping of small motions about a
    /// position.
    pub fn truth(&self, position_mm: f64) -> [f64; 3] {
        match &self.mechanics {
            Mechanics::Pneumatic(p) => {
                let linear = Linearised::new(p, position_mm, 0.0);
                [linear.gain, linear.omega0, linear.xi]
            }
            Mechanics::ThirdOrder(p) => [p.gain, p.omega0, p.xi],
        }
    }

    /// Share by which a rod makes it slower towards larger positions, and faster towards smaller
    /// ones; what a load does is not in it.
    pub fn imbalance(&self) -> f64 {
        match &self.mechanics {
            Mechanics::Pneumatic(p) => {
                let (a, b) = (p.area_a(), p.area_b());
                (b - a) / (b + a)
            }
            Mechanics::ThirdOrder(p) => p.imbalance,
        }
    }

    /// Half width of the dead zone, and offset of the valve.
    pub fn valve_null(&self) -> [f64; 2] {
        match &self.mechanics {
            Mechanics::Pneumatic(p) => [p.dead_zone, p.offset],
            Mechanics::ThirdOrder(p) => [p.valve.dead_zone, p.valve.offset],
        }
    }

    /// Dead time and lag of the valve \[s\].
    pub fn delay(&self) -> f64 {
        let (frequency, damping) = match &self.mechanics {
            Mechanics::Pneumatic(p) => (p.spool_frequency, p.spool_damping),
            Mechanics::ThirdOrder(p) => (p.spool_frequency, p.spool_damping),
        };
        self.dead_time + 2.0 * damping / frequency
    }

    /// Standard deviation of the measured position, resolution included \[mm\].
    pub fn sigma_mm(&self) -> f64 {
        ((self.noise_mm * self.noise_mm) / 3.0 + self.resolution_mm * self.resolution_mm / 12.0)
            .sqrt()
    }

    /// Range of the position at rest beyond which the axis cycles \[mm\].
    pub fn cycle_mm(&self) -> f64 {
        4.0 * self.resolution_mm + 4.0 * self.noise_mm / 3.0_f64.sqrt() + 0.05
    }

    /// Motion that the drive can carry out, for the loop and the practitioner alike.
    pub fn limits(&self) -> Limits {
        let length = self.stroke_mm();
        let [gain, omega0, _] = self.truth(0.5 * length);
        let [dead_zone, _] = self.valve_null();
        let acceleration = (0.25 * gain * omega0).min(0.03 * omega0 * omega0 * length);
        Limits {
            velocity: 0.6 * gain * (1.0 - dead_zone),
            acceleration,
            jerk: acceleration * omega0,
        }
    }
}

/// Velocity gain that an axis needs \[mm/s\]: for a full stroke in some 16/w0, and never more than
/// 2 m/s.
fn needed_gain(omega0: f64, stroke_mm: f64) -> f64 {
    (0.125 * omega0 * stroke_mm).min(2000.0)
}

/// Draws a pneumatic axis; `None` when it is out of the range of frequencies or too weak for its
/// load.
fn pneumatic(kind: Family, usual: bool, random: &mut Random) -> Option<Mechanics> {
    let mut draw = |range: Range| range.draw(usual, random);
    let bore = draw(family::BORE);
    let stroke_mm = draw(family::STROKE);
    let mass = draw(family::MASS);
    let coulomb = draw(kind.friction()) * Friction::SEALS.coulomb * bore / 0.032;
    let stroke = 1e-3 * stroke_mm;
    let mut p = AxisParameters {
        bore,
        rod: 0.0,
        stroke,
        dead_length: stroke * draw(family::DEAD_VOLUME),
        mass,
        load: mass * GRAVITY * draw(family::GRAVITY),
        friction: Friction {
            coulomb,
            breakaway: coulomb * draw(family::BREAKAWAY),
            viscous: draw(family::VISCOUS) * Friction::SEALS.viscous * bore / 0.032,
            stribeck_velocity: Friction::SEALS.stribeck_velocity,
        },
        supply_bar: draw(family::SUPPLY),
        // The root of ISO 6358 meets its straight line at a gentler slope, so that longer steps of
        // the integrator suffice.
        linear_ratio: 0.98,
        valve_leakage: draw(family::LEAK),
        piston_leakage: draw(family::LEAK),
        spool_frequency: std::f64::consts::TAU * draw(kind.valve_hz()),
        dead_zone: draw(kind.dead_zone()),
        offset: draw(kind.offset()),
        start_mm: stroke_mm * draw(family::START),
        ..AxisParameters::SERVO
    };
    let size = draw(family::VALVE_SIZE);
    if kind == Family::SingleRod {
        p.rod = bore * draw(family::ROD);
    }
    let holds = p.load.abs() + p.friction.breakaway;
    let linear = Linearised::new(&p, 0.5 * stroke_mm, 0.0);
    let omega0 = if usual {
        kind.omega0().usual()
    } else {
        kind.omega0()
    };
    let strong = holds <= family::LOAD_MAX * 1e5 * p.supply_bar * p.area_a();
    if !strong || !omega0.contains(linear.omega0) {
        return None;
    }
    // The velocity gain is proportional to the conductance.
    p.conductance *= size * needed_gain(linear.omega0, stroke_mm) / linear.gain;
    Some(Mechanics::Pneumatic(p))
}

/// Draws a drive of third order.
fn third_order(kind: Family, usual: bool, random: &mut Random) -> Mechanics {
    let mut draw = |range: Range| range.draw(usual, random);
    let stroke = draw(family::STROKE);
    let omega0 = draw(kind.omega0());
    let xi = draw(kind.xi());
    let coulomb = draw(kind.friction()) * omega0 * omega0 * stroke;
    let gain = draw(family::VALVE_SIZE) * needed_gain(omega0, stroke);
    let mut drive = ThirdOrderParameters {
        gain,
        omega0,
        xi,
        leak: 0.0,
        // Twice what an undamped oscillation at full speed takes.
        force_max: 2.0 * gain * omega0,
        load: 0.0,
        imbalance: 0.0,
        friction: Friction {
            coulomb,
            breakaway: coulomb * draw(family::BREAKAWAY),
            viscous: 0.0,
            stribeck_velocity: 30.0,
        },
        stroke,
        valve: StaticValve {
            dead_zone: draw(kind.dead_zone()),
            offset: draw(kind.offset()),
            ..StaticValve::IDEAL
        },
        spool_frequency: std::f64::consts::TAU * draw(kind.valve_hz()),
        spool_damping: 0.7,
        start: stroke * draw(family::START),
    };
    if kind == Family::Differential {
        // Both edges of a symmetrical valve take the supply together: out the piston goes with
        // v^2 (1 + r^3) and in with v^2 (1 + r^3) / r, so that it is sqrt(r) times as fast in.
        let slower = draw(family::ROD_SIDE).sqrt();
        let imbalance = (1.0 - slower) / (1.0 + slower);
        let extends_up: bool = random.random();
        drive.imbalance = if extends_up { -imbalance } else { imbalance };
    }
    Mechanics::ThirdOrder(drive)
}
