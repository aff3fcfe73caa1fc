//! Sizes of the axis in SI units.

use super::friction::Friction;

/// Reference pressure of ISO 8778 and pressure of the room \[Pa\].
pub(super) const AMBIENT: f64 = 1.0e5;
/// Reference temperature of ISO 8778 \[K\]; the air of the chambers is taken at it.
pub(super) const TEMPERATURE: f64 = 293.15;
/// Gas constant of air \[J/(kg K)\].
pub(super) const GAS: f64 = 287.0;
/// Density of air in the reference state of ISO 8778 \[kg/m3\].
pub(super) const DENSITY: f64 = 1.185;

/// Everything that describes an axis; `docs/pneumatic-axis.md` has the sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisParameters {
    /// Bore of the cylinder \[m\].
    pub bore: f64,
    /// Diameter of the rod through chamber B \[m\]; 0 for a rodless cylinder.
    pub rod: f64,
    /// Travel between the end stops \[m\].
    pub stroke: f64,
    /// Dead volume of each chamber with its tube, as a length of the bore \[m\].
    pub dead_length: f64,
    /// Moving mass \[kg\].
    pub mass: f64,
    /// Constant force on the mass toward larger positions, such as its weight along the axis \[N\].
    pub load: f64,
    /// Friction of seals and guide.
    pub friction: Friction,
    /// Supply pressure above ambient \[bar\].
    pub supply_bar: f64,
    /// Polytropic exponent of the air, 1 (isothermal) to 1.4 (adiabatic).
    pub polytropic: f64,
    /// Sonic conductance of one edge of the valve at full opening \[m3/(s Pa)\].
    pub conductance: f64,
    /// Critical pressure ratio of the valve, below 1.
    pub critical_ratio: f64,
    /// Pressure ratio above which the flow is linear in the pressure drop, above the critical ratio
    /// and below 1.
    pub linear_ratio: f64,
    /// Leakage of each edge of the closed valve, as a part of its conductance.
    pub valve_leakage: f64,
    /// Leakage past the piston, as a part of the conductance of the valve.
    pub piston_leakage: f64,
    /// Natural frequency of the spool \[rad/s\].
    pub spool_frequency: f64,
    /// Damping of the spool.
    pub spool_damping: f64,
    /// Half width of the dead zone in units of the command.
    pub dead_zone: f64,
    /// Offset of the spool in units of the command.
    pub offset: f64,
    /// Factor on the opening of the valve, 1 nominally.
    pub valve_gain: f64,
    /// Half width of the uniform noise of the sensor \[mm\].
    pub sensor_noise_mm: f64,
    /// Resolution of the sensor \[mm\].
    pub resolution_mm: f64,
    /// Integrator steps in one sample of 1 ms.
    pub substeps: u32,
    /// Position at the start, from the stop on the side of chamber A \[mm\].
    pub start_mm: f64,
}

impl AxisParameters {
    /// The servo axis of the project's figures: rodless, 32 mm bore, 400 mm stroke, 5 kg, 6 bar,
    /// dead zone 3 %.
    pub const SERVO: Self = Self {
        bore: 0.032,
        rod: 0.0,
        stroke: 0.4,
        dead_length: 0.02,
        mass: 5.0,
        load: 0.0,
        friction: Friction::SEALS,
        supply_bar: 6.0,
        polytropic: 1.2,
        conductance: 1.375e-8,
        critical_ratio: 0.3,
        linear_ratio: 0.999,
        valve_leakage: 2e-3,
        piston_leakage: 5e-4,
        spool_frequency: 628.0,
        spool_damping: 0.7,
        dead_zone: 0.03,
        offset: 0.0,
        valve_gain: 1.0,
        sensor_noise_mm: 0.01,
        resolution_mm: 0.01,
        substeps: 20,
        start_mm: 200.0,
    };

    /// The same with a rod of 12 mm on one side, so that both directions differ.
    pub const SINGLE_ROD: Self = Self {
        rod: 0.012,
        ..Self::SERVO
    };

    /// Area of the piston toward chamber A \[m2\].
    pub fn area_a(&self) -> f64 {
        0.25 * std::f64::consts::PI * self.bore * self.bore
    }

    /// Area of the piston toward chamber B \[m2\].
    pub fn area_b(&self) -> f64 {
        self.area_a() - 0.25 * std::f64::consts::PI * self.rod * self.rod
    }

    /// Volume of the chambers A and B at a position \[m3\].
    pub fn volumes(&self, position: f64) -> [f64; 2] {
        [
            self.area_a() * (self.dead_length + position),
            self.area_b() * (self.dead_length + self.stroke - position),
        ]
    }

    /// Absolute supply pressure \[Pa\].
    pub fn supply(&self) -> f64 {
        AMBIENT + 1e5 * self.supply_bar
    }

    /// Names the first parameter that makes no physical sense.
    pub(super) fn fault(&self) -> Option<&'static str> {
        let f = &self.friction;
        [
            (self.bore > 0.0, "bore"),
            (self.rod >= 0.0 && self.rod < self.bore, "rod"),
            (self.stroke > 0.0, "stroke"),
            (self.dead_length > 0.0, "dead_length"),
            (self.mass > 0.0, "mass"),
            (self.load.is_finite(), "load"),
            (f.coulomb >= 0.0 && f.breakaway >= f.coulomb, "friction"),
            (f.viscous >= 0.0 && f.stribeck_velocity > 0.0, "friction"),
            (self.supply_bar >= 0.0, "supply_bar"),
            ((1.0..=1.4).contains(&self.polytropic), "polytropic"),
            (self.conductance > 0.0, "conductance"),
            (
                0.0 <= self.critical_ratio && self.critical_ratio < self.linear_ratio,
                "critical_ratio",
            ),
            (self.linear_ratio < 1.0, "linear_ratio"),
            (self.valve_leakage >= 0.0, "valve_leakage"),
            (self.piston_leakage >= 0.0, "piston_leakage"),
            (self.spool_frequency > 0.0, "spool_frequency"),
            (self.spool_damping > 0.0, "spool_damping"),
            ((0.0..1.0).contains(&self.dead_zone), "dead_zone"),
            (self.offset.abs() < 1.0, "offset"),
            (self.valve_gain >= 0.0, "valve_gain"),
            (self.sensor_noise_mm >= 0.0, "sensor_noise_mm"),
            (self.resolution_mm > 0.0, "resolution_mm"),
            (self.substeps > 0, "substeps"),
            (
                (0.0..=1e3 * self.stroke).contains(&self.start_mm),
                "start_mm",
            ),
        ]
        .iter()
        .find_map(|&(good, name)| (!good).then_some(name))
    }
}
