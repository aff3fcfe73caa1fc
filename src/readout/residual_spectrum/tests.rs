//! The sums by moments against the sums of the regressors themselves, in double precision.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::*;

type C = [f64; 2];

fn times([a, b]: C, [c, d]: C) -> C {
    [a * c - b * d, a * d + b * c]
}

fn inverse([a, b]: C) -> C {
    let size = a * a + b * b;
    [a / size, -b / size]
}

fn size([a, b]: C) -> f64 {
    a * a + b * b
}

/// `(j w)^power`.
fn power_of(w: f64, power: usize) -> C {
    (0..power).fold([1.0, 0.0], |value, _| times(value, [0.0, w]))
}

/// A polynomial with these coefficients at j w, and with a leading one behind them.
fn polynomial(b: &[f32], w: f64) -> C {
    b.iter().enumerate().fold([0.0; 2], |[re, im], (k, b)| {
        let [x, y] = power_of(w, k);
        [re + f64::from(*b) * x, im + f64::from(*b) * y]
    })
}

fn monic(a: &[f32], w: f64) -> C {
    let ([re, im], [x, y]) = (polynomial(a, w), power_of(w, a.len()));
    [re + x, im + y]
}

const PARAMETERS: [Parameter; 7] = [
    Parameter::Output { power: 1 },
    Parameter::Output { power: 2 },
    Parameter::Input { input: 0, power: 0 },
    Parameter::Input { input: 0, power: 1 },
    Parameter::Input { input: 1, power: 0 },
    Parameter::Constant,
    Parameter::InitialState,
];
const UNITS: [f32; 7] = [400.0, 20.0, 4e5, 2e4, 3e5, 70.0, 50.0];
const THETA: [f32; 7] = [380.0, 15.0, 9e5, 3e4, -2e5, 0.0, 0.0];

fn spectrum(duration: f32) -> ResidualSpectrum<'static, 3, 7> {
    ResidualSpectrum {
        parameters: PARAMETERS,
        units: &UNITS,
        theta: &THETA,
        denominator: [0.0, 380.0, 15.0],
        filter: [64_000.0, 4800.0, 120.0],
        natural: 19.0,
        duration,
        slowest: 40.0,
    }
}

/// R and S by their definition.
fn exact(spectrum: &ResidualSpectrum<'_, 3, 7>) -> [[[f64; 7]; 7]; 2] {
    let natural = f64::from(spectrum.natural);
    let frequencies = grid().map(|x| natural * f64::from(x));
    let residual = frequencies
        .map(|w| size(monic(&spectrum.denominator, w)) / size(monic(&spectrum.filter, w)));
    // What a Lorentz curve of both sides leaves of it.
    let width = 3.0 / f64::from(spectrum.duration);
    let blurred = frequencies.map(|w| {
        let kernel = |v: f64| {
            let at = |d: f64| 1.0 / (width * width + d * d);
            (at(w - v) + at(w + v)) * v
        };
        let weighted = frequencies
            .iter()
            .zip(&residual)
            .map(|(v, r)| kernel(*v) * r);
        weighted.sum::<f64>() / frequencies.iter().map(|v| kernel(*v)).sum::<f64>()
    });
    let mut sums = [[[0.0; 7]; 7]; 2];
    // Per unit of the weight of the sums: omega over the filter, both in natural frequencies.
    let weight = |w: f64| w / natural * natural.powi(6) / size(monic(&spectrum.filter, w));
    for input in 0..2 {
        let lead = PARAMETERS
            .iter()
            .position(|p| matches!(p, Parameter::Input { input: of, .. } if *of == input))
            .unwrap_or(0);
        // The first parameter of an input is seen with a size of one.
        let range = 1.0 / f64::from(UNITS[lead]);
        let b = PARAMETERS.map(|p| match p {
            Parameter::Input { input: of, power } if of == input => Some(power),
            _ => None,
        });
        for (w, blurred) in frequencies.into_iter().zip(blurred) {
            let numerator = b
                .iter()
                .zip(THETA)
                .fold([0.0; 2], |[re, im], (power, value)| {
                    let [x, y] = power.map_or([0.0; 2], |power| power_of(w, power));
                    [re + f64::from(value) * x, im + f64::from(value) * y]
                });
            let g = times(numerator, inverse(monic(&spectrum.denominator, w)));
            let phi: [Option<C>; 7] = core::array::from_fn(|j| {
                let unit = f64::from(UNITS[j]) * range;
                let [re, im] = match PARAMETERS[j] {
                    Parameter::Output { power } => times([-1.0, 0.0], times(g, power_of(w, power))),
                    Parameter::Input { input: of, power } if of == input => power_of(w, power),
                    _ => return None,
                };
                Some([unit * re, unit * im])
            });
            for i in 0..7 {
                for j in 0..7 {
                    if let (Some([a, b]), Some([c, d])) = (phi[i], phi[j]) {
                        let entry = weight(w) * (a * c + b * d);
                        sums[0][i][j] += entry;
                        sums[1][i][j] += entry * blurred;
                    }
                }
            }
        }
    }
    add_own(&mut sums, frequencies, blurred, weight);
    sums
}

/// A constant and an initial state act at low frequencies, below their own rate.
fn add_own(
    sums: &mut [[[f64; 7]; 7]; 2],
    frequencies: [f64; FREQUENCIES],
    blurred: [f64; FREQUENCIES],
    weight: impl Fn(f64) -> f64,
) {
    let natural: f64 = 19.0;
    for (place, rate) in [(5, f64::from(LOWEST) * natural), (6, 40.0)] {
        for (w, blurred) in frequencies.into_iter().zip(blurred) {
            let entry = weight(w) * natural * natural / (w * w + rate * rate);
            sums[0][place][place] += entry;
            sums[1][place][place] += entry * blurred;
        }
    }
}

#[test]
fn a_polynomial_is_evaluated_on_the_imaginary_axis() {
    // 1 + 2 jx + 3 (jx)^2 + 4 (jx)^3 at 1/2 and at 2.
    for (x, re, im) in [(0.5, 0.25, 0.5), (2.0, -11.0, -28.0)] {
        let found = value_of(&[1.0, 2.0, 3.0, 4.0], x);
        assert_eq!([found.re, found.im], [re, im]);
    }
}

#[test]
fn frequencies_are_in_proportion_from_a_twentieth_to_three_and_a_half() {
    let grid = grid();
    assert_eq!(grid[0], 0.05);
    assert!(
        (grid[FREQUENCIES - 1] / 3.464 - 1.0).abs() < 1e-3,
        "{grid:?}"
    );
    for pair in grid.windows(2) {
        assert!((pair[1] / pair[0] / 1.47 - 1.0).abs() < 1e-6);
    }
}

#[test]
fn sums_by_moments_are_those_of_the_regressors() {
    for duration in [0.3, 2.0, 100.0] {
        let spectrum = spectrum(duration);
        let (r, s) = spectrum.sums();
        let exact = exact(&spectrum);
        for (found, exact) in [r, s].iter().zip(&exact) {
            for i in 0..7 {
                for j in 0..7 {
                    let size = (exact[i][i] * exact[j][j]).sqrt();
                    let error = (f64::from(found[i][j]) - exact[i][j]).abs();
                    assert!(
                        error < 1e-4 * size,
                        "{duration} {i} {j}: {} {}",
                        found[i][j],
                        exact[i][j]
                    );
                }
            }
        }
    }
}

#[test]
fn a_natural_frequency_is_that_of_the_denominator_where_it_is_a_sensible_one() {
    // Behind one integrator and without one; of third order: the mean of three poles.
    assert!((natural_frequency(&[0.0, 400.0, 20.0], 30.0) - 20.0).abs() < 1e-4);
    assert!((natural_frequency(&[-8000.0, 0.0, 0.0], 30.0) - 20.0).abs() < 1e-3);
    assert!((natural_frequency(&[0.0, 0.0, 20.0], 30.0) - 20.0).abs() < 1e-4);
    // Not within ten times the bandwidth, or none at all.
    for (a1, natural) in [(9.1_f32, 9.1), (8.9, 90.0), (899.0, 899.0), (901.0, 90.0)] {
        let found = natural_frequency(&[a1], 90.0);
        assert!((found - natural).abs() < 1e-2, "{a1}: {found}");
    }
    assert_eq!(natural_frequency(&[0.0; 3], 30.0), 30.0);
    assert_eq!(natural_frequency(&[f32::NAN, 1.0], 30.0), 30.0);
}

#[test]
fn the_mean_in_the_band_is_weighted_as_the_trend_is() {
    for (a, filter) in [
        ([0.0, 400.0, 20.0], [64_000.0, 4800.0, 120.0]),
        ([9000.0, 500.0, 12.0], [800.0, 440.0, 22.0]),
    ] {
        let natural = f64::from(natural_frequency(&a, 20.0));
        let (mut sum, mut weights) = (0.0, 0.0);
        for step in 1..=25 {
            let w = natural * 0.1 * f64::from(step);
            let (plant, filter) = (size(monic(&a, w)), size(monic(&filter, w)));
            let weight = w.powi(6) / (plant * filter);
            sum += weight * plant / filter;
            weights += weight;
        }
        let found = f64::from(in_band(&a, &filter, 20.0));
        assert!(
            (found / (sum / weights) - 1.0).abs() < 1e-4,
            "{found} {}",
            sum / weights
        );
    }
    // A residual as white as the noise.
    assert!((in_band(&[0.0, 400.0, 20.0], &[0.0, 400.0, 20.0], 20.0) - 1.0).abs() < 1e-5);
    assert_eq!(in_band(&[f32::NAN; 3], &[1.0; 3], 20.0), 1.0);
}
