//! Gain and phase at the crossover: a cascade and a PID controller for a bandwidth.
//!
//! For plants whose b_0 is above 0: the gains are above 0, too. The characteristic function of a
//! loop with an integral part is `k_i b_0` at s = 0 and grows towards infinity along the real axis,
//! whatever the poles and the delay of the plant are, so it is 0 in between where `k_i b_0` is
//! below 0.

use nalgebra::Complex;

use super::controller::{Cascade, Pid};
use super::plant::SampledPlant;

/// The velocity loop is so many times faster than the position loop.
const INNER: f64 = 3.0;

/// Phase margins that are aimed at: of the velocity loop, of a PID loop \[rad\].
const INNER_MARGIN: f64 = 65.0 * std::f64::consts::PI / 180.0;
const MARGIN: f64 = 60.0 * std::f64::consts::PI / 180.0;

/// Least and largest lag of a PI controller at the crossover \[rad\]: an integral time of four and
/// of a sixth of 1/W.
const LEAST_LAG: f64 = 0.245;
const LARGEST_LAG: f64 = 1.4;

/// Integral time of a PID controller in units of 1/W.
const INTEGRAL: f64 = 5.0;

/// The filter of a derivative is so many times faster than what it is for.
const FILTER: f64 = 10.0;

/// The phase of a plant from 0 downwards, -360 to 0 degrees \[rad\].
fn lag(value: Complex<f64>) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    let phase = value.arg().rem_euclid(turn) - turn;
    if phase <= -turn + 1e-9 { 0.0 } else { phase }
}

/// Integral time for a lag of the PI controller at `omega`.
fn integral_time(lag: f64, omega: f64) -> f64 {
    1.0 / (omega * lag.clamp(LEAST_LAG, LARGEST_LAG).tan())
}

/// Gains of a cascade whose position loop has this bandwidth \[rad/s\].
pub(super) fn cascade(plant: &SampledPlant, bandwidth: f64) -> Option<Cascade> {
    let dt = plant.dt;
    let inner = INNER * bandwidth;
    if inner * dt >= 2.0 {
        return None;
    }
    let tf = 1.0 / (FILTER * inner);
    let z = Complex::new(0.0, inner * dt).exp();
    let alpha = dt / (tf + dt);
    // The filtered difference of the position.
    let difference = (z - 1.0) / (z * dt);
    let filter = z * alpha / (z - (1.0 - alpha));
    let velocity = plant.response(inner) * difference * filter;
    let left = lag(velocity) + std::f64::consts::PI - INNER_MARGIN;
    let ti = integral_time(left, inner);
    let pi = Complex::new(1.0, -1.0 / (inner * ti));
    let kp = 1.0 / (velocity * pi).norm();
    kp.is_finite().then_some(Cascade {
        kv: bandwidth,
        kp,
        ti,
        tf,
    })
}

/// Gains of a PID controller whose loop crosses one at this frequency \[rad/s\].
pub(super) fn pid(plant: &SampledPlant, bandwidth: f64) -> Option<Pid> {
    let value = plant.response(bandwidth);
    let wanted = MARGIN - std::f64::consts::PI - lag(value);
    let controller = |ti: f64, td: f64| {
        let s = Complex::new(0.0, bandwidth);
        (s * ti).inv() + s * td / (s * (td / FILTER) + 1.0) + 1.0
    };
    let (ti, td) = if wanted < -LEAST_LAG {
        (integral_time(-wanted, bandwidth), 0.0)
    } else {
        let ti = INTEGRAL / bandwidth;
        // The lead grows up to about WTd = 3; where it does not suffice the sensitivity says so.
        let (mut low, mut high) = (0.0, 3.0 / bandwidth);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match controller(ti, middle).arg() < wanted {
                true => low = middle,
                false => high = middle,
            }
        }
        (ti, high)
    };
    let kp = 1.0 / (value * controller(ti, td)).norm();
    kp.is_finite().then_some(Pid {
        kp,
        ti,
        td,
        tf: td / FILTER,
    })
}
