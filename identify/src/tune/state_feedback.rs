//! Feedback of the states from an observer that also finds a constant force at the input.
//!
//! ```text
//! e      = y - C x                                           prediction one sample ahead
//! x     <- A x + B_0 v(k-d) + B_1 v(k-d-1) + L e             v = u + w
//! w     <- w + L_w e                                         the disturbance at the input, in units of u
//! u      = N r - K x(k+d) - K_u v(k-1) - w                   x(k+d): the state that the inputs under way lead to
//! ```
//!
//! Poles of the plant that are slower than the bandwidth go onto a circle of that radius; faster
//! ones stay where they are, because to slow them down costs robustness. The observer likewise, at
//! three times the bandwidth.

use nalgebra::{Complex, DMatrix, DVector, RowDVector};

use super::controller::Controller;
use super::model::Model;
use super::placement::{circle, equal, gains};
use super::plant::SampledPlant;
use crate::polynomials::roots;

/// Where the input does not reach all states, or the output does not show them.
const UNPLACED: &str = "its poles cannot be placed";

/// The observer is so many times faster than the feedback.
const OBSERVER: f64 = 3.0;

/// Gains of a state feedback with its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct StateFeedback {
    /// u per unit of each state: of y and its derivatives where the plant has no zeros, otherwise
    /// of w and its derivatives, `A(s) w = u`, `y = B(s) w`.
    pub k: Vec<f64>,
    /// u per unit of the input before, 0 unless the delay ends between samples.
    pub k_input: f64,
    /// u per unit of the reference.
    pub n: f64,
    /// The states and, at the end, the disturbance per unit of the prediction error, one sample
    /// ahead.
    pub l: Vec<f64>,
    /// Whether the states are y and its derivatives.
    pub derivatives: bool,
}

impl StateFeedback {
    /// For a plant whose gain is `gain` times that of the one that it is for.
    pub(super) fn for_gain(mut self, gain: f64) -> Self {
        // y keeps its unit; w becomes smaller by the gain, as u and the disturbance do.
        let kept = if self.derivatives { self.k.len() } else { 0 };
        if self.derivatives {
            self.k.iter_mut().for_each(|k| *k /= gain);
        }
        self.l.iter_mut().skip(kept).for_each(|l| *l /= gain);
        self.n /= gain;
        self
    }
}

/// Why a bandwidth is none of a state feedback.
pub(super) const IDLE: &str =
    "every pole of the plant is stable and at or above the bandwidth: nothing would be fed back";

/// The gains and the controller for a bandwidth \[rad/s\].
///
/// # Errors
/// [`IDLE`]; poles that cannot be placed.
pub(super) fn design(
    plant: &SampledPlant,
    model: &Model,
    bandwidth: f64,
) -> Result<(StateFeedback, Controller), &'static str> {
    let own = roots(&model.a).ok_or(UNPLACED)?;
    if kept(&own, bandwidth, plant.dt).1 == 0 {
        return Err(IDLE);
    }
    placed(plant, model, bandwidth, &own).ok_or(UNPLACED)
}

/// Slower poles on the circle; `None` where they cannot be placed.
fn placed(
    plant: &SampledPlant,
    model: &Model,
    bandwidth: f64,
    own: &[(f64, f64)],
) -> Option<(StateFeedback, Controller)> {
    let (m, b) = (plant.order(), &model.b);
    let both = &plant.b[0] + &plant.b[1];
    let between = plant.b[1].iter().any(|b| *b != 0.0);
    let step = plant.rate * plant.dt;
    let (mut wanted, slow) = kept(own, bandwidth, plant.dt);
    wanted.extend(circle(slow, bandwidth, plant.dt));
    let (k, k_input) = if between {
        // The input before is a state, its pole at 0.
        let mut a = DMatrix::zeros(m + 1, m + 1);
        a.view_mut((0, 0), (m, m)).copy_from(&plant.a);
        a.view_mut((0, m), (m, 1)).copy_from(&plant.b[1]);
        let mut input = DVector::zeros(m + 1);
        input.rows_mut(0, m).copy_from(&plant.b[0]);
        input[m] = 1.0;
        wanted.push(0.0.into());
        let k = gains(&a, &input, &wanted, step)?;
        (k.columns(0, m).into_owned(), k[m])
    } else {
        (gains(&plant.a, &plant.b[0], &wanted, step)?, 0.0)
    };
    // The disturbance acts as the input does.
    let mut watched = DMatrix::identity(m + 1, m + 1);
    watched.view_mut((0, 0), (m, m)).copy_from(&plant.a);
    watched.view_mut((0, m), (m, 1)).copy_from(&both);
    let mut seen = DVector::zeros(m + 1);
    for i in 0..m {
        seen[i] = plant.c[i];
    }
    let (mut fast, slow) = kept(own, OBSERVER * bandwidth, plant.dt);
    fast.extend(equal(slow + 1, OBSERVER * bandwidth, plant.dt));
    let l = gains(&watched.transpose(), &seen, &fast, step)?.transpose();
    let n = reference_gain(plant, &both, &k, k_input)?;
    let controller = controller(plant, &both, (&k, k_input, n), &l);
    let derivatives = b.len() == 1;
    // y^(i) = b_0 w^(i) = b_0 state / rate^(m-i).
    let gain = if derivatives { b[0] } else { 1.0 };
    let unit = |i: usize| plant.rate.powi((m - i) as i32) / gain;
    let gains = StateFeedback {
        k: (0..m).map(|i| k[i] * unit(i)).collect(),
        k_input,
        n,
        l: (0..=m)
            .map(|i| if i < m { l[i] / unit(i) } else { l[i] })
            .collect(),
        derivatives,
    };
    Some((gains, controller))
}

/// Stable poles of the plant from `rate` on, as poles of the samples, and how many others there
/// are.
fn kept(own: &[(f64, f64)], rate: f64, dt: f64) -> (Vec<Complex<f64>>, usize) {
    let fast = own
        .iter()
        .filter(|(re, im)| *re < 0.0 && re.hypot(*im) >= rate);
    let kept: Vec<_> = fast
        .map(|(re, im)| (Complex::new(*re, *im) * dt).exp())
        .collect();
    let others = own.len() - kept.len();
    (kept, others)
}

/// N: in equilibrium at the reference, the feedback gives what holds it there.
fn reference_gain(
    plant: &SampledPlant,
    both: &DVector<f64>,
    k: &RowDVector<f64>,
    k_input: f64,
) -> Option<f64> {
    let m = plant.order();
    let mut matrix = DMatrix::zeros(m + 1, m + 1);
    matrix
        .view_mut((0, 0), (m, m))
        .copy_from(&(&plant.a - DMatrix::identity(m, m)));
    matrix.view_mut((0, m), (m, 1)).copy_from(both);
    matrix.view_mut((m, 0), (1, m)).copy_from(&plant.c);
    let mut right = DVector::zeros(m + 1);
    right[m] = 1.0;
    let rest = matrix.full_piv_lu().solve(&right)?;
    let n = (k * rest.rows(0, m))[0] + (1.0 + k_input) * rest[m];
    n.is_finite().then_some(n)
}

/// States: x, w, u(k-1) .. u(k-d-1).
fn controller(
    plant: &SampledPlant,
    both: &DVector<f64>,
    (k, k_input, n): (&RowDVector<f64>, f64, f64),
    l: &DVector<f64>,
) -> Controller {
    let (m, d) = (plant.order(), plant.delay);
    let size = m + 1 + d + 1;
    let past = |lag: usize| m + lag;
    // x(k+d) in the states: every input under way, and the disturbance with it.
    let mut ahead = DMatrix::zeros(m, size);
    ahead.view_mut((0, 0), (m, m)).fill_with_identity();
    for j in 0..d {
        ahead = &plant.a * ahead;
        for i in 0..m {
            ahead[(i, past(d - j))] += plant.b[0][i];
            ahead[(i, past(d - j + 1))] += plant.b[1][i];
            ahead[(i, m)] += both[i];
        }
    }
    let mut c = -(k * ahead);
    c[m] -= 1.0 + k_input;
    c[past(1)] -= k_input;
    let mut a = DMatrix::zeros(size, size);
    let mut b = [DVector::zeros(size), DVector::zeros(size)];
    a.view_mut((0, 0), (m, m)).copy_from(&plant.a);
    a.view_mut((0, m), (m, 1)).copy_from(both);
    a[(m, m)] = 1.0;
    for i in 0..=m {
        for j in 0..m {
            a[(i, j)] -= l[i] * plant.c[j];
        }
        b[1][i] = l[i];
    }
    for i in 0..m {
        for (share, lag) in plant.b.iter().zip([d, d + 1]) {
            if lag == 0 {
                for j in 0..size {
                    a[(i, j)] += share[i] * c[j];
                }
                b[0][i] += share[i] * n;
            } else {
                a[(i, past(lag))] += share[i];
            }
        }
    }
    for j in 0..size {
        a[(past(1), j)] = c[j];
    }
    b[0][past(1)] = n;
    for lag in 2..=d + 1 {
        a[(past(lag), past(lag - 1))] = 1.0;
    }
    Controller {
        a,
        b,
        c,
        d: [n, 0.0],
        past: d + 1,
    }
}
