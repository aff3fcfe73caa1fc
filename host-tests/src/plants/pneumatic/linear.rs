//! Linear model of the axis around a position.

use super::flow::{AIR, mass_flow, resting_pressures};
use super::parameters::{AMBIENT, AxisParameters};

/// Small motions around a position,
/// `x(s)/u(s) = C w0^2 / (s (s^2 + 2 xi w0 s + w0^2)) = b0 / (s (s^2 + a2 s + a1))`.
///
/// The axis slides (Coulomb friction constant, viscous friction linear), the spool follows at once,
/// nothing leaks, u counts beyond the dead zone, and both chambers are at the pressures at which
/// the axis rests. With the stiffness of each chamber `k_i = n A_i^2 p_i / V_i`, its flow gain
/// `g_i` and flow slope per pressure `l_i` (both from the ISO 6358 curve):
///
/// ```text
/// m v' = F - Fv v        F' = -(k_A + k_B) v + K u - lambda F
/// K = sum n R T A_i g_i / V_i     lambda = sum k_i l_i / sum k_i
/// a2 = Fv/m + lambda     a1 = (k_A + k_B + lambda Fv)/m     b0 = K/m
/// ```
///
/// `g_i` is the mean of the edges that feed and vent a chamber, times the valve gain. `lambda`
/// vanishes with the closed valve and grows with the mean opening; one lambda for both chambers is
/// exact in the middle of an axis with equal areas only. The spool adds a delay of about
/// `2 zeta / w` (2.2 ms with the parameters of `SERVO`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearised {
    /// Velocity gain C \[mm/s per unit command\].
    pub gain: f64,
    /// Natural frequency \[rad/s\].
    pub omega0: f64,
    /// Damping.
    pub xi: f64,
    /// Coefficients a1 \[1/s2\], a2 \[1/s\] and b0 \[mm/s3 per unit\].
    pub coefficients: [f64; 3],
}

impl Linearised {
    /// Linearises at a position \[mm\] and at a mean magnitude of `PneumaticAxis::opening` (0 for
    /// the closed valve).
    pub fn new(p: &AxisParameters, position_mm: f64, mean_opening: f64) -> Self {
        let supply = p.supply();
        let [pa, pb] = resting_pressures(p);
        let volumes = p.volumes(1e-3 * position_mm);
        let (mut stiffness, mut drive, mut relaxation) = (0.0, 0.0, 0.0);
        for (area, pressure, volume) in [(p.area_a(), pa, volumes[0]), (p.area_b(), pb, volumes[1])]
        {
            // Half of the time a chamber is fed, half of the time vented; both for an opening of 1.
            let net = |pressure: f64| {
                let q = |p1, p2| mass_flow(p.conductance, p.critical_ratio, p.linear_ratio, p1, p2);
                [q(supply, pressure), -q(pressure, AMBIENT)]
            };
            let [fed, vented] = net(pressure);
            let h = 1e-4 * pressure;
            let (up, down) = (net(pressure + h), net(pressure - h));
            let slope = 0.5 * (up[0] + up[1] - down[0] - down[1]) / (2.0 * h);
            let k = p.polytropic * area * area * pressure / volume;
            let rate = -p.polytropic * AIR * slope * mean_opening.abs() / volume;
            stiffness += k;
            drive += p.polytropic * AIR * area * p.valve_gain * 0.5 * (fed - vented) / volume;
            relaxation += k * rate;
        }
        let lambda = relaxation / stiffness;
        let viscous = p.friction.viscous;
        let a1 = (stiffness + lambda * viscous) / p.mass;
        let a2 = viscous / p.mass + lambda;
        let b0 = 1e3 * drive / p.mass;
        let omega0 = a1.sqrt();
        Self {
            gain: b0 / a1,
            omega0,
            xi: 0.5 * a2 / omega0,
            coefficients: [a1, a2, b0],
        }
    }
}
