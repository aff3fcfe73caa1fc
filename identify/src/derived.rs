//! Quantities that follow from the parameters, with their standard deviations (delta method).

use crate::estimate::Estimate;
use crate::problem::Problem;

/// Name of the input that a force balance takes as Coulomb friction.
pub const COULOMB: &str = "sgn(v)";

/// Name of the input behind `first` that tells the width of its dead zone: the sign of what passes.
pub fn sign_of(first: &str) -> String {
    format!("sgn({first})")
}

/// A value with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// In the units of the signals and s.
    pub value: f64,
    /// First order in the parameters; not finite where they do not determine it.
    pub sigma: f64,
}

impl Problem<'_> {
    /// Place of a_i in theta.
    fn place_a(&self, i: usize) -> Option<usize> {
        let first = usize::from(self.structure.integrator);
        (first..self.structure.order)
            .contains(&i)
            .then(|| i - first)
    }

    /// Place of b_0 of an input in theta.
    fn place_b(&self, input: usize) -> usize {
        let before = &self.signals.inputs[..input];
        let b: usize = before.iter().map(|input| self.terms(input)).sum();
        self.structure.order - usize::from(self.structure.integrator) + b
    }

    /// A value whose derivatives by some entries of theta are given.
    fn quantity(
        &self,
        estimate: &Estimate,
        value: f64,
        derivatives: &[(Option<usize>, f64)],
    ) -> Quantity {
        let mut gradient = vec![0.0; estimate.theta.len()];
        for (place, derivative) in derivatives {
            if let Some(place) = place {
                gradient[*place] += derivative;
            }
        }
        let sigma = estimate.sigma_of(&gradient);
        Quantity { value, sigma }
    }

    /// Static gain of an input, or velocity gain behind an integrator: b_0 over the lowest a_i.
    pub fn gain(&self, estimate: &Estimate, input: usize) -> Quantity {
        let lowest = usize::from(self.structure.integrator);
        let (a, b) = (estimate.a.get(lowest).copied(), estimate.b[input][0]);
        let a = a.unwrap_or(1.0); // an integrator alone
        let by = [
            (Some(self.place_b(input)), 1.0 / a),
            (self.place_a(lowest), -b / (a * a)),
        ];
        self.quantity(estimate, b / a, &by)
    }

    /// Half width of the dead zone of a valve that the record shows, in units of the first input;
    /// of a model with that input.
    pub fn dead_zone(&self, estimate: &Estimate) -> Option<Quantity> {
        let [first, second, ..] = &self.signals.inputs[..] else {
            return None;
        };
        if second.name != sign_of(first.name) {
            return None;
        }
        let c = 1;
        let (b, width) = (estimate.b[0][0], -estimate.b[c][0] / estimate.b[0][0]);
        let by = [
            (Some(self.place_b(c)), -1.0 / b),
            (Some(self.place_b(0)), -width / b),
        ];
        Some(self.quantity(estimate, width, &by))
    }

    /// Time constants of the real poles \[s\].
    ///
    /// `T = -1/p` and `dp/da_i = -p^i / A'(p)`; a double pole has no finite standard deviation.
    pub fn time_constants(&self, estimate: &Estimate) -> Vec<Quantity> {
        let m = self.structure.order;
        let time_constant = |t: &f64| {
            let p = -1.0 / t;
            let slope = (1..m).fold(m as f64 * p.powi(m as i32 - 1), |sum, i| {
                sum + i as f64 * estimate.a[i] * p.powi(i as i32 - 1)
            });
            let by: Vec<_> = (0..m)
                .map(|i| (self.place_a(i), -p.powi(i as i32 - 2) / slope))
                .collect();
            self.quantity(estimate, *t, &by)
        };
        let found = estimate.reading.time_constants.iter();
        found.map(time_constant).collect()
    }

    /// Real and imaginary part of the poles behind the integrator \[rad/s\], slowest first;
    /// derivatives by differences.
    pub fn poles(&self, estimate: &Estimate) -> Vec<(Quantity, Quantity)> {
        let integrators = usize::from(self.structure.integrator);
        let of = |theta: &[f64]| {
            self.polynomials(theta)
                .poles(integrators)
                .unwrap_or_default()
        };
        let at = of(&estimate.theta);
        let mut gradients = vec![
            [
                vec![0.0; estimate.theta.len()],
                vec![0.0; estimate.theta.len()]
            ];
            at.len()
        ];
        for j in 0..self.structure.order - integrators {
            let step = 1e-5 * estimate.theta[j].abs() + 1e-5 * estimate.sigma[j];
            let mut moved = estimate.theta.clone();
            moved[j] += step;
            for ((gradient, at), (re, im)) in gradients.iter_mut().zip(&at).zip(of(&moved)) {
                gradient[0][j] = (re - at.0) / step;
                gradient[1][j] = (im - at.1) / step;
            }
        }
        let quantity = |value: f64, gradient: &[f64]| Quantity {
            value,
            sigma: estimate.sigma_of(gradient),
        };
        let both = at.iter().zip(&gradients);
        both.map(|((re, im), [by_re, by_im])| (quantity(*re, by_re), quantity(*im, by_im)))
            .collect()
    }

    /// What a force balance `u = J v' + F v + Fc sgn(v) + offset` calls the parameters of
    /// `1/(s (s + a_1))`, in units of the first input; empty for other structures.
    pub fn force_balance(&self, estimate: &Estimate) -> Vec<(&'static str, Quantity)> {
        let [b] = estimate.b[0][..] else {
            return Vec::new();
        };
        if !(self.structure.integrator && self.structure.order == 2) || b == 0.0 {
            return Vec::new();
        }
        let by_b = |numerator: f64| (Some(self.place_b(0)), -numerator / (b * b));
        let over_b = |numerator: f64, place: Option<usize>, sign: f64| {
            let by = [(place, sign / b), by_b(sign * numerator)];
            self.quantity(estimate, sign * numerator / b, &by)
        };
        let mut balance = vec![
            ("inertia", self.quantity(estimate, 1.0 / b, &[by_b(1.0)])),
            ("viscous", over_b(estimate.a[1], self.place_a(1), 1.0)),
        ];
        let inputs = &self.signals.inputs;
        if let Some(c) = inputs.iter().position(|input| input.name == COULOMB) {
            let friction = over_b(estimate.b[c][0], Some(self.place_b(c)), -1.0);
            balance.push(("coulomb", friction));
        }
        if self.structure.constant {
            let place = Some(self.place_b(inputs.len()));
            balance.push(("offset", over_b(estimate.constant, place, -1.0)));
        }
        balance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Hold;
    use crate::estimate::Reading;
    use crate::problem::{Options, Structure};
    use crate::signals::{Input, Signals};

    /// An estimate of which one parameter is uncertain.
    fn estimate(theta: [f64; 4], varied: usize) -> Estimate {
        let mut covariance = vec![vec![0.0; 4]; 4];
        covariance[varied][varied] = 1.0;
        Estimate {
            theta: theta.to_vec(),
            sigma: vec![1.0; 4],
            covariance,
            a: vec![0.0, theta[0]],
            b: vec![vec![theta[1]], vec![theta[2]]],
            constant: theta[3],
            reading: Reading {
                gain: None,
                omega0: None,
                damping: None,
                time_constants: vec![1.0 / theta[0]],
                poles: None,
                stable: true,
            },
            reading_sigma: None,
        }
    }

    /// Every derivative against a difference, by a covariance of one parameter at a time.
    #[test]
    fn sigmas_are_the_derivatives_by_each_parameter() {
        let x: Vec<f64> = (0..90).map(|k| f64::from(k % 7)).collect();
        let input = |name| Input {
            name,
            samples: &x,
            delayed: name == "u",
            hold: Hold::Zero,
        };
        let signals = Signals {
            dt: 0.1,
            output: &x,
            inputs: vec![input("u"), input(COULOMB)],
            standstill: None,
        };
        let structure = Structure {
            integrator: true,
            constant: true,
            ..Structure::of_order(2)
        };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        let all = |e: &Estimate| {
            let mut all = vec![problem.gain(e, 0), problem.gain(e, 1)];
            all.extend(problem.time_constants(e));
            all.extend(problem.force_balance(e).into_iter().map(|(_, q)| q));
            all
        };
        let theta = [2.0, 0.5, -0.3, 0.1];
        for varied in 0..4 {
            let step = 1e-6;
            let mut moved = theta;
            moved[varied] += step;
            let (now, then) = (all(&estimate(theta, varied)), all(&estimate(moved, varied)));
            assert_eq!(now.len(), 7);
            for (k, (now, then)) in now.iter().zip(&then).enumerate() {
                let slope = ((then.value - now.value) / step).abs();
                assert!(
                    (now.sigma - slope).abs() < 1e-4 * (1.0 + slope),
                    "{k} by {varied}: {} {slope}",
                    now.sigma
                );
            }
        }
    }
}
