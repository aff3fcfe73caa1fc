//! How far a loop is from instability.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::controller::Controller;
use super::frequency_response::FrequencyResponse;
use super::plant::SampledPlant;
use super::stability::is_stable;

/// Frequencies of a sweep in a decade.
const IN_A_DECADE: f64 = 80.0;
/// Decades of the sweep below half the sampling frequency, at least.
const DECADES: f64 = 5.0;
/// The sweep begins at this share of the bandwidth, at most: a loop crosses one within a few times
/// its bandwidth, and an integral part turns the phase a decade below.
const BELOW: f64 = 0.01;
/// Half of the frequencies around a resonance, as many half widths of it to both sides as the
/// hyperbolic sine of a tenth of that: by a tenth of the half width at its top, to 200 of them.
const AROUND: i32 = 60;
/// Steps that sharpen a crossing.
const BISECTIONS: usize = 40;

/// Margins of a loop that is broken at the input of the plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Smallest factor on the gain that makes the loop unstable; infinite where none does.
    pub gain: f64,
    /// Smallest lag that does \[deg\].
    pub phase_deg: f64,
    /// Smallest delay that does \[s\].
    pub delay: f64,
    /// Largest amplification of a disturbance of the output: `max |1/(1+L)|`.
    pub max_sensitivity: f64,
    /// Where the gain of the loop crosses one last \[rad/s\].
    pub crossover: f64,
    /// Whether all poles of the closed loop are inside the unit circle.
    pub stable: bool,
}

impl Margins {
    /// The worse of two in each figure.
    pub(super) fn worse(self, other: Self) -> Self {
        Self {
            gain: self.gain.min(other.gain),
            phase_deg: self.phase_deg.min(other.phase_deg),
            delay: self.delay.min(other.delay),
            max_sensitivity: self.max_sensitivity.max(other.max_sensitivity),
            crossover: self.crossover.max(other.crossover),
            stable: self.stable && other.stable,
        }
    }
}

/// Frequencies up to half the sampling frequency: evenly on a logarithmic scale, and close around
/// the resonances of the plant, which may be narrower.
fn frequencies(plant: &SampledPlant, bandwidth: f64) -> Vec<f64> {
    let top = 0.999 * PI / plant.dt;
    let decades = (top / (BELOW * bandwidth)).log10().max(DECADES);
    let count = (IN_A_DECADE * decades).ceil();
    let even = (0..=count as usize).map(|k| top * 10f64.powf(decades * (k as f64 / count - 1.0)));
    let mut all: Vec<f64> = even.collect();
    for pole in plant
        .a
        .complex_eigenvalues()
        .iter()
        .map(|z| z.ln() / plant.dt)
    {
        if pole.im > 0.0 {
            let near = |k: i32| pole.im + pole.re * (0.1 * f64::from(k)).sinh();
            all.extend((-AROUND..=AROUND).map(near));
        }
    }
    all.retain(|omega| *omega > 0.0 && *omega <= top);
    all.sort_by(f64::total_cmp);
    all
}

/// The margins of a controller with a plant, and the worst with others beside it; `None` where one
/// exceeds the limit of the sensitivity.
pub(super) fn with_others(
    plant: &SampledPlant,
    others: &[SampledPlant],
    controller: &Controller,
    (bandwidth, limit): (f64, f64),
) -> Option<[Margins; 2]> {
    let response = FrequencyResponse::new(controller, plant.dt);
    let margins = |plant| margins(plant, (controller, &response), (bandwidth, limit));
    let nominal = margins(plant)?;
    let worst = others
        .iter()
        .try_fold(nominal, |worst, plant| Some(worst.worse(margins(plant)?)))?;
    Some([nominal, worst])
}

/// The margins of a controller for a bandwidth with a plant; `None` where the sensitivity exceeds a
/// limit.
pub(super) fn margins(
    plant: &SampledPlant,
    (controller, response): (&Controller, &FrequencyResponse),
    (bandwidth, limit): (f64, f64),
) -> Option<Margins> {
    let found = of_frequencies(plant, response, (bandwidth, limit))?;
    (found.max_sensitivity <= limit).then(|| Margins {
        stable: is_stable(plant, controller),
        ..found
    })
}

/// What the frequency response shows, which does not tell whether the loop is stable.
fn of_frequencies(
    plant: &SampledPlant,
    response: &FrequencyResponse,
    (bandwidth, limit): (f64, f64),
) -> Option<Margins> {
    let open = |omega: f64| plant.response(omega) * response.at(omega);
    let sensitivity = |l: Complex<f64>| 1.0 / (l + 1.0).norm();
    let grid = frequencies(plant, bandwidth);
    let within = |l: &Complex<f64>| sensitivity(*l) <= limit;
    let values = grid.iter().map(|omega| Some(open(*omega)).filter(within));
    let values: Vec<Complex<f64>> = values.collect::<Option<_>>()?;
    let mut found = Margins {
        gain: f64::INFINITY,
        phase_deg: f64::INFINITY,
        delay: f64::INFINITY,
        max_sensitivity: 0.0,
        crossover: 0.0,
        stable: false,
    };
    for k in 0..grid.len() {
        found.max_sensitivity = found.max_sensitivity.max(sensitivity(values[k]));
        let Some((next, now)) = values.get(k + 1).zip(Some(values[k])) else {
            break;
        };
        let [low, high] = [grid[k], grid[k + 1]];
        if (now.norm() - 1.0) * (next.norm() - 1.0) < 0.0 {
            let omega = crossing(low, high, |omega| open(omega).norm() - 1.0);
            // The lag down to -180 degrees, from 0 to 360.
            let lag = (open(omega).arg() + PI).rem_euclid(2.0 * PI);
            found.phase_deg = found.phase_deg.min(lag.to_degrees());
            found.phase_deg = found.phase_deg.min(360.0 - lag.to_degrees());
            found.delay = found.delay.min(lag / omega);
            found.crossover = found.crossover.max(omega);
        }
        // The negative real axis.
        if now.im * next.im < 0.0 && now.re.min(next.re) < 0.0 {
            let omega = crossing(low, high, |omega| open(omega).im);
            let real = open(omega).re;
            if real < 0.0 {
                let factor = -1.0 / real;
                found.gain = found.gain.min(factor.max(1.0 / factor));
            }
        }
    }
    let largest =
        |x: &usize, y: &usize| sensitivity(values[*x]).total_cmp(&sensitivity(values[*y]));
    if let Some(peak) = (0..grid.len()).max_by(largest) {
        let (mut low, mut high) = (
            grid[peak.saturating_sub(1)],
            grid[(peak + 1).min(grid.len() - 1)],
        );
        for _ in 0..BISECTIONS {
            let third = (high - low) / 3.0;
            let [left, right] = [low + third, high - third].map(|omega| sensitivity(open(omega)));
            match left < right {
                true => low += third,
                false => high -= third,
            }
            found.max_sensitivity = found.max_sensitivity.max(left.max(right));
        }
    }
    Some(found)
}

fn crossing(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    let sign = f(low).signum();
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match f(middle).signum() == sign {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}
