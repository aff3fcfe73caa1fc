//! Mass flow of air through a restriction after ISO 6358.

use super::parameters::{AMBIENT, AxisParameters, DENSITY, TEMPERATURE};

/// Mass flow from `p1` to `p2` \[kg/s\], negative when `p2 > p1`.
///
/// `q = C rho0 p1 w(p2/p1)` for air at the reference temperature, with `w = 1` up to the critical
/// ratio `b` (sonic), `w = sqrt(1 - ((r - b)/(1 - b))^2)` up to `linear` (subsonic), and from there
/// a straight line to `w(1) = 0`, because the root has an infinite slope at `r = 1`. Conductance in
/// m3/(s Pa), absolute pressures in Pa.
pub fn mass_flow(conductance: f64, b: f64, linear: f64, p1: f64, p2: f64) -> f64 {
    let (high, low, sign) = if p1 >= p2 {
        (p1, p2, 1.0)
    } else {
        (p2, p1, -1.0)
    };
    sign * conductance * DENSITY * high * flow_function(b, linear, low / high)
}

/// The flow function `w` of a pressure ratio in 0..=1.
pub(super) fn flow_function(b: f64, linear: f64, ratio: f64) -> f64 {
    let root = |r: f64| {
        let z = (r - b) / (1.0 - b);
        (1.0 - z * z).sqrt()
    };
    if ratio <= b {
        1.0
    } else if ratio <= linear {
        root(ratio)
    } else {
        root(linear) * (1.0 - ratio) / (1.0 - linear)
    }
}

/// Pressure at which air flows in from `supply` and out to `ambient` through equal restrictions.
///
/// Both chambers of the resting axis settle there, and there the valve gain of both directions is
/// equal.
pub(super) fn balance(b: f64, linear: f64, supply: f64, ambient: f64) -> f64 {
    let (mut low, mut high) = (ambient, supply);
    // Inflow falls and outflow rises with the pressure: bisection to the last bit.
    for _ in 0..60 {
        let p = 0.5 * (low + high);
        if mass_flow(1.0, b, linear, supply, p) > mass_flow(1.0, b, linear, p, ambient) {
            low = p;
        } else {
            high = p;
        }
    }
    0.5 * (low + high)
}

/// Absolute pressures of the chambers A and B of an axis that rests under its load \[Pa\]: about
/// the pressure that a leaking valve settles at.
pub(super) fn resting_pressures(p: &AxisParameters) -> [f64; 2] {
    let level = balance(p.critical_ratio, p.linear_ratio, p.supply(), AMBIENT);
    // With a rod the areas differ and so do the pressures of a resting axis.
    let rod = p.area_a() - p.area_b();
    let a = (level * p.area_b() + AMBIENT * rod) / p.area_a();
    [
        a - 0.5 * p.load / p.area_a(),
        level + 0.5 * p.load / p.area_b(),
    ]
}

/// Temperature times gas constant: pressure times volume of a kilogram of air \[J/kg\].
pub(super) const AIR: f64 = super::parameters::GAS * TEMPERATURE;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regimes_meet() {
        let (b, linear) = (0.3, 0.999);
        assert_eq!(flow_function(b, linear, 0.1), 1.0);
        assert_eq!(flow_function(b, linear, 1.0), 0.0);
        for edge in [b, linear] {
            let gap = flow_function(b, linear, edge + 1e-9) - flow_function(b, linear, edge - 1e-9);
            assert!(gap.abs() < 1e-6, "gap {gap} at {edge}");
        }
        // By hand: r = 6/7 gives z = 39/49 and w = sqrt(49^2 - 39^2)/49.
        assert!((flow_function(b, linear, 6.0 / 7.0) - 880.0_f64.sqrt() / 49.0).abs() < 1e-15);
    }

    #[test]
    fn flow_is_odd_and_sonic_flow_ignores_the_back_pressure() {
        let q = |p1, p2| mass_flow(1.375e-8, 0.3, 0.999, p1, p2);
        assert_eq!(q(7e5, 5e5), -q(5e5, 7e5));
        assert_eq!(q(7e5, 1e5), q(7e5, 2e5));
        // C p1 rho0 = 1.375e-8 * 7e5 * 1.185.
        assert!((q(7e5, 1e5) - 0.011_405_625).abs() < 1e-12);
    }

    #[test]
    fn balance_holds_the_flow() {
        let p = balance(0.3, 0.999, 7e5, 1e5);
        let net = mass_flow(1e-8, 0.3, 0.999, 7e5, p) - mass_flow(1e-8, 0.3, 0.999, p, 1e5);
        assert!(net.abs() < 1e-15, "net flow {net} at {p}");
    }
}
