//! The dead zone of a valve: the two inputs that such a valve is linear in, and where it lies in a
//! record.
//!
//! ```text
//! flow = K (x - W sgn x) for |x| > W, else 0      x = u - centre
//!      = K [x where |x| > w] - K W [sgn x where |x| > w]          for a taken half width w near W
//! ```
//!
//! So the model tells the width W by the ratio of two coefficients, and the taken w only which
//! commands pass. Half width and centre are found as filter and delay are: by free simulation of
//! folds of the record that the model has not seen, on a grid that is then refined.

use crate::derived::sign_of;
use crate::error::Error;
use crate::filter_choice::{choose, judged};
use crate::folds::{Folds, Refitted};
use crate::instruments::Method;
use crate::problem::{Options, Problem, Structure};
use crate::search::{Choice, Freedom};
use crate::side_by_side::side_by_side;
use crate::signals::{Input, Signals};

/// Half widths of the grid, and distances of the centre from zero, over the largest command.
const WIDTHS: [f64; 9] = [0.0, 0.01, 0.02, 0.03, 0.045, 0.06, 0.08, 0.11, 0.15];
const CENTRES: [f64; 5] = [-0.06, -0.03, 0.0, 0.03, 0.06];

/// First step of the refinement over the largest command; it is halved from round to round, the
/// grid being the first.
const STEP: f64 = 0.01;
const ROUNDS: usize = 4;

/// Commands that a valve lets pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadZone {
    /// Half of the width, in the unit of the command.
    pub half_width: f64,
    /// The command in the middle.
    pub centre: f64,
}

impl DeadZone {
    /// What passes, and the sign of it.
    pub fn inputs(&self, u: &[f64]) -> [Vec<f64>; 2] {
        let passes = |u: &f64| match (u - self.centre).abs() > self.half_width {
            true => u - self.centre,
            false => 0.0,
        };
        let sign = |x: &f64| if *x == 0.0 { 0.0 } else { x.signum() };
        let through: Vec<f64> = u.iter().map(passes).collect();
        let signs = through.iter().map(sign).collect();
        [through, signs]
    }

    /// The dead zone behind the first input of `signals` whose model simulates best.
    ///
    /// Cost: as [`identify`](crate::identify) without a delay to find, and some 70 fits at one
    /// filter.
    ///
    /// # Errors
    /// As [`identify`](crate::identify).
    pub fn find(
        signals: &Signals,
        structure: Structure,
        options: Options,
        freedom: Freedom,
    ) -> Result<Self, Error> {
        let Some(command) = signals.inputs.first() else {
            return Err(Error::Inputs(0));
        };
        let largest = command.samples.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        let delay = match freedom.delay {
            Choice::Given(delay) => delay as f64,
            Choice::Auto => 0.0,
        };
        let poles = match freedom.pole {
            Choice::Given(Some(pole)) => vec![pole],
            _ => crate::filter_choice::poles(signals.output.len(), signals.dt),
        };
        let name = sign_of(command.name);
        let at = |zone: Self, poles: &[f64]| -> Result<(Folds, f64), Error> {
            let [through, signs] = zone.inputs(command.samples);
            let signals = signals.behind(&through, &name, &signs);
            let problem = Problem::new(&signals, structure, options)?;
            let judged = match poles {
                [pole] => judged(&problem, *pole, delay, Method::Instruments)
                    .ok_or_else(|| problem.cannot_simulate())?,
                _ => choose(&problem, poles, delay, &())?,
            };
            Ok((judged.folds, judged.pole))
        };
        let none = Self {
            half_width: 0.0,
            centre: 0.0,
        };
        let (folds, pole) = at(none, &poles)?;
        let mut tried = vec![(none, folds)];
        let mut zones = grid(largest);
        let mut step = STEP * largest;
        for _ in 0..ROUNDS {
            let found = side_by_side(&zones, |zone| Some((*zone, at(*zone, &[pole]).ok()?.0)));
            tried.extend(found.into_iter().flatten());
            zones = best(&tried).around(step);
            step *= 0.5;
        }
        Ok(best(&tried))
    }

    /// The eight neighbours at a distance.
    fn around(&self, step: f64) -> Vec<Self> {
        let mut all = Vec::new();
        for width in [-step, 0.0, step] {
            for centre in [-step, 0.0, step] {
                all.push(Self {
                    half_width: (self.half_width + width).max(0.0),
                    centre: self.centre + centre,
                });
            }
        }
        all
    }
}

/// The sharpest of those that simulate as well as the best within one standard error, as filters
/// are chosen.
fn best(tried: &[(DeadZone, Folds)]) -> DeadZone {
    let error = |(_, folds): &&(DeadZone, Folds)| folds.total(Refitted::StateAndConstant);
    let smallest = tried.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
    let near = tried.iter().filter(|(_, folds)| {
        smallest.is_none_or(|(_, best)| folds.behind(best, Refitted::StateAndConstant) <= 1.0)
    });
    let sharpest = near.min_by(|a, b| a.1.sharpness().total_cmp(&b.1.sharpness()));
    sharpest.map_or(tried[0].0, |(zone, _)| *zone)
}

fn grid(largest: f64) -> Vec<DeadZone> {
    let each = WIDTHS
        .iter()
        .flat_map(|width| CENTRES.map(|centre| (width, centre)));
    each.map(|(width, centre)| DeadZone {
        half_width: width * largest,
        centre: centre * largest,
    })
    .collect()
}

impl<'a> Signals<'a> {
    /// The same with what passes a dead zone in place of the first input, and the sign of it behind
    /// that.
    fn behind(&self, through: &'a [f64], name: &'a str, signs: &'a [f64]) -> Self {
        let mut signals = self.clone();
        let Some(first) = signals.inputs.first_mut() else {
            return signals;
        };
        first.samples = through;
        let sign = Input {
            name,
            samples: signs,
            ..*first
        };
        signals.inputs.insert(1, sign);
        signals
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y' = -2 y + 6 f(u)` behind a dead zone of 0.1 about 0.04.
    #[test]
    fn a_dead_zone_is_found_where_it_lies() {
        let valve = DeadZone {
            half_width: 0.1,
            centre: 0.04,
        };
        let (mut state, mut y, decay) = (1_u32, vec![0.0], (-0.02_f64).exp());
        let u: Vec<f64> = (0..4000)
            .map(|k| {
                if k % 23 == 0 {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                }
                f64::from(state >> 8) / f64::from(1 << 23) - 1.0
            })
            .collect();
        let [through, signs] = valve.inputs(&u);
        for k in 0..3999 {
            let flow = through[k] - valve.half_width * signs[k];
            y.push(decay * y[k] + 3.0 * (1.0 - decay) * flow);
        }
        let signals = Signals::held(0.01, &u, &y);
        let structure = Structure {
            constant: true,
            ..Structure::of_order(1)
        };
        let found = DeadZone::find(&signals, structure, Options::default(), Freedom::default())
            .expect("a dead zone");
        assert!((found.half_width - 0.1).abs() < 0.015, "{found:?}");
        assert!((found.centre - 0.04).abs() < 0.015, "{found:?}");
    }

    #[test]
    fn what_passes_and_its_sign() {
        let zone = DeadZone {
            half_width: 0.5,
            centre: 1.0,
        };
        assert_eq!(
            zone.inputs(&[0.0, 0.6, 1.5, 2.0]),
            [vec![-1.0, 0.0, 0.0, 1.0], vec![-1.0, 0.0, 0.0, 1.0]]
        );
    }
}
