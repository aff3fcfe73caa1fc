//! theta as polynomials, and with its covariance as an estimate.

use nalgebra::DMatrix;

use crate::estimate::Estimate;
use crate::polynomials::Polynomials;
use crate::problem::Problem;

impl Problem<'_> {
    /// theta as polynomials.
    pub(crate) fn polynomials(&self, theta: &[f64]) -> Polynomials {
        let first = usize::from(self.structure.integrator);
        let q = self.structure.order - first;
        let mut a = vec![0.0; first];
        a.extend(&theta[..q]);
        let mut place = q;
        let mut b = Vec::new();
        for input in &self.signals.inputs {
            let terms = self.terms(input);
            b.push(theta[place..place + terms].to_vec());
            place += terms;
        }
        let constant = theta.get(place).copied().unwrap_or(0.0);
        Polynomials { a, b, constant }
    }

    /// A model with its covariance as an estimate.
    pub(crate) fn estimate_of(
        &self,
        model: Polynomials,
        theta: Vec<f64>,
        covariance: &DMatrix<f64>,
    ) -> Estimate {
        let integrators = usize::from(self.structure.integrator);
        let reading = model.reading(integrators);
        let sigma: Vec<f64> = (0..theta.len())
            .map(|j| covariance[(j, j)].sqrt())
            .collect();
        let rows = (0..theta.len()).map(|i| covariance.row(i).iter().copied().collect());
        let mut estimate = Estimate {
            covariance: rows.collect(),
            a: model.a,
            b: model.b,
            constant: model.constant,
            reading,
            reading_sigma: None,
            theta,
            sigma,
        };
        estimate.reading_sigma = Some(self.reading_sigma(&estimate));
        estimate
    }

    /// The estimate with an error in the direction and of the size of each of these moves.
    pub(crate) fn widened(&self, estimate: &Estimate, moves: &[Vec<f64>]) -> Estimate {
        let n = estimate.theta.len();
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let moved: f64 = moves.iter().map(|moved| moved[i] * moved[j]).sum();
            estimate.covariance[i][j] + moved
        });
        let theta = estimate.theta.clone();
        self.estimate_of(self.polynomials(&theta), theta, &covariance)
    }

    /// Standard deviations of gain, natural frequency and damping, by differences.
    fn reading_sigma(&self, estimate: &Estimate) -> [f64; 3] {
        let integrators = usize::from(self.structure.integrator);
        let read = |theta: &[f64]| {
            let reading = self.polynomials(theta).reading(integrators);
            [reading.gain, reading.omega0, reading.damping].map(|v| v.unwrap_or(f64::NAN))
        };
        let at = read(&estimate.theta);
        let mut gradients = [(); 3].map(|()| vec![0.0; estimate.theta.len()]);
        for j in 0..estimate.theta.len() {
            let step = 1e-4 * estimate.theta[j].abs() + 1e-4 * estimate.sigma[j];
            if !(step > 0.0) {
                continue;
            }
            let mut moved = estimate.theta.clone();
            moved[j] += step;
            for (k, moved) in read(&moved).into_iter().enumerate() {
                gradients[k][j] = (moved - at[k]) / step;
            }
        }
        gradients.map(|gradient| estimate.sigma_of(&gradient))
    }
}
