//! Trends that are exact at any sample time: the numerators of the hold and the poles of the s plane.

use crate::chain::FilteredTrends;
use crate::error::{ConfigError, positive};
use crate::filter;
use crate::trend::{Hold, Image, NoiseGain, Scheme, TrendOperator, Trends};
use crate::warp::{scaled, to_continuous, to_gamma};

/// Terms of `tanh(x)/x`: the next one is below 1e-8 for |x| = 1.
const TERMS: usize = 20;

/// Coefficients of `tanh(x)/x = sum c_k x^2k`.
const TANH: [f32; TERMS] = {
    // tanh' = 1 - tanh^2
    let mut c = [0.0; TERMS];
    c[0] = 1.0;
    let mut k = 1;
    while k < TERMS {
        let mut square = 0.0;
        let mut i = 0;
        while i < k {
            square += c[i] * c[k - 1 - i];
            i += 1;
        }
        c[k] = -square / (2 * k + 1) as f32;
        k += 1;
    }
    c
};

/// [`FilteredTrends`] for signals that are sampled slowly: a dozen samples per period and fewer.
///
/// `Departs from (8):` nothing of y is interpolated in the equation
/// `A_g(gamma) y = N(gamma) u` that the samples of y obey. Its poles are
/// `gamma_p = (2/Delta) tanh(p Delta/2)`, its numerators those of the hold:
///
/// ```text
/// 1/(s-p)  held from sample to sample:   2 q^-1/(1+q^-1)  phi_p / (gamma - gamma_p)       phi_p = gamma_p / p
///          straight from one to the next: phi_p^2 / (gamma - gamma_p) + (phi_p - 1)/p
/// ```
///
/// The trend j of an input is replaced by `N_j(gamma)` of `s^j/A(s)` over the filter. The plant's own A is
/// not known at first: the filter stands for it until [`ExactTrends::with_model`] puts an estimate in its
/// place. With the right A every parameter is exact, whatever Delta and the filter; with another one the
/// numerators are wrong by its distance times `(omega Delta)^2 / 12`. The model is read in the s plane,
/// with the gain (behind the integrators) that was found.
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | Delta | `sample_time` | s |
/// | `A_f` | `filter`, every pole below 2/Delta | rad^(m-i)/s^(m-i) |
///
/// Cost: m^2 multiplications for each input more than [`FilteredTrends`], which is the
/// one to take at 1 kHz.
///
/// # Examples
/// ```
/// use trendid::{Config, ExactTrends, Identifier, Structure};
/// // An oscillator of 420 rad/s, damping 0.05, sampled nine times in a period.
/// let (w, xi, dt) = (420.0_f32, 0.05_f32, 0.001_66_f32);
/// let trends = ExactTrends::from_polynomial(dt, [w * w, 2.0 * xi * w])?;
/// let config = Config::new(Structure::<2, 3, 1>::new(
///     trendid::Terms::up_to(2), [trendid::Terms::of(&[0])], false), w, [1.0], 1.0);
/// let mut identifier: Identifier<_, 2, 3> = Identifier::try_new(&config, trends)?;
/// // The exact response to a held input: two real recursions of the damped oscillation.
/// let (decay, angle) = ((-xi * w * dt).exp(), w * (1.0 - xi * xi).sqrt() * dt);
/// let (mut y, mut v) = (0.0_f32, 0.0_f32); // y - u and the quadrature of the oscillation
/// let mut before = 0.0;
/// for k in 0..600 {
///     let u = if (k / 7) % 2 == 0 { 1.0 } else { -1.0 };
///     let _ = identifier.update(u, before);
///     let (e, ratio) = (before - u, xi / (1.0 - xi * xi).sqrt());
///     y = u + decay * (e * (angle.cos() + ratio * angle.sin()) + v * angle.sin());
///     v = decay * (v * (angle.cos() - ratio * angle.sin()) - e * (1.0 + ratio * ratio) * angle.sin());
///     before = y;
/// }
/// let a = identifier.transfer_function().a;
/// assert!((a[0] / (w * w) - 1.0).abs() < 1e-4 && (a[1] / (2.0 * xi * w) - 1.0).abs() < 1e-3);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactTrends<const M: usize> {
    chain: FilteredTrends<M>,
    /// Row j: weights of the trends in the numerator of s^j/A for a held input.
    zero: [[f32; M]; M],
    /// The same for an input that runs straight, and the weight of the input itself.
    first: [[f32; M]; M],
    direct: [f32; M],
}

impl<const M: usize> ExactTrends<M> {
    /// Trends behind `1/A_f(s)`, `A_f = s^m + filter[m-1] s^{m-1} + .. + filter[0]`, with the numerators of A = `A_f`.
    ///
    /// # Errors
    /// [`ConfigError::Order`], [`ConfigError::SampleTime`], [`ConfigError::FilterPole`] where `A_f` is not
    /// stable or has a pole at 2/Delta or above.
    pub fn from_polynomial(sample_time: f32, filter: [f32; M]) -> Result<Self, ConfigError> {
        if !positive(sample_time) {
            return Err(ConfigError::SampleTime(sample_time));
        }
        // The map of the poles keeps their half plane: what is refused there is unstable here.
        let image = to_gamma(&filter, sample_time).ok_or(beyond(&filter))?;
        Self {
            chain: FilteredTrends::from_polynomial(Scheme::Tustin, sample_time, image)?,
            zero: [[0.0; M]; M],
            first: [[0.0; M]; M],
            direct: [0.0; M],
        }
        .with_model(filter)
    }

    /// The same filter with the numerators of a plant `A = s^m + a[m-1] s^{m-1} + .. + a[0]`, stable or not.
    ///
    /// # Errors
    /// [`ConfigError::FilterPole`] where A has a pole at 2/Delta or above.
    pub fn with_model(self, a: [f32; M]) -> Result<Self, ConfigError> {
        let image = to_gamma(&a, self.chain.sample_time()).ok_or(beyond(&a))?;
        let mut trends = self;
        trends.set_numerators(&a, &image);
        Ok(trends)
    }

    /// Trends behind the default filter for a plant of rough bandwidth omega (rad/s), see [`FilteredTrends::for_bandwidth`].
    ///
    /// # Errors
    /// As [`ExactTrends::from_polynomial`], [`ConfigError::Bandwidth`].
    pub fn for_bandwidth(sample_time: f32, bandwidth: f32) -> Result<Self, ConfigError> {
        if M == 0 || M > 4 {
            return Err(ConfigError::Order(M));
        }
        if !positive(bandwidth) {
            return Err(ConfigError::Bandwidth(bandwidth));
        }
        Self::from_polynomial(sample_time, filter::for_bandwidth(bandwidth))
    }

    /// The numerators, from the state equations of 1/A with s^j/A as states.
    ///
    /// With X the matrix of these equations and b their input, in units of 2/Delta,
    /// `N(gamma) = adj(gamma - tanh X) w`, w = (tanh X / X) b for a held input,
    /// (tanh X / X)^2 b for a straight one, which also has the direct way d = `((tanh X / X) - 1)/X b`:
    /// `d A_g/A_f = d + sum d (a_g - f)_i gamma^i/A_f`.
    fn set_numerators(&mut self, a: &[f32; M], image: &[f32; M]) {
        let half = 0.5 * self.chain.sample_time();
        let (a, image) = (scaled(a, half), scaled(image, half));
        let filter = scaled(&self.chain.filter(), half);
        let mut b = [0.0; M];
        if let Some(last) = b.last_mut() {
            *last = 1.0;
        }
        let held = tanh_ratio(&b, &a);
        let straight = tanh_ratio(&held, &a);
        // (tanh(x)/x - 1)/x = c_1 x + c_2 x^3 + ..
        self.direct = [0.0; M];
        let mut odd = times(&b, &a);
        for c in TANH.iter().skip(1) {
            for (d, x) in self.direct.iter_mut().zip(odd) {
                *d += c * x;
            }
            odd = times(&times(&odd, &a), &a);
        }
        for (rows, w) in [(&mut self.zero, held), (&mut self.first, straight)] {
            // adj(gamma - G) = sum gamma^i (G^(m-1-i) + image_{m-1} G^(m-2-i) + .. + image_{i+1})
            let mut column = w;
            for i in (0..M).rev() {
                for (row, value) in rows.iter_mut().zip(column) {
                    row[i] = value;
                }
                let moved = times(&tanh_ratio(&column, &a), &a);
                for j in 0..M {
                    column[j] = moved[j] + image[i] * w[j];
                }
            }
        }
        for (row, d) in self.first.iter_mut().zip(self.direct) {
            for (i, value) in row.iter_mut().enumerate() {
                *value += d * (image[i] - filter[i]);
            }
        }
        // Back from units of 2/Delta: (Delta/2)^(i-j), and (Delta/2)^(m-j) for the direct way.
        for j in 0..M {
            for i in 0..M {
                for _ in j..i {
                    self.zero[j][i] *= half;
                    self.first[j][i] *= half;
                }
                for _ in i..j {
                    self.zero[j][i] /= half;
                    self.first[j][i] /= half;
                }
            }
            for _ in j..M {
                self.direct[j] *= half;
            }
        }
    }

    /// Factor from the numerators found to those of a model with denominator a in the s plane, a_g in gamma.
    ///
    /// The gain behind the integrators is what the samples have told, so it stands.
    fn numerator(&self, a: &[f32; M], image: &[f32; M], integrators: usize) -> f32 {
        // N_0 at rest: of s^0/A.
        let own = self
            .zero
            .first()
            .and_then(|row| row.first())
            .copied()
            .unwrap_or(1.0);
        match (a.get(integrators), image.get(integrators)) {
            (Some(a), Some(image)) if *image != 0.0 => own * a / image,
            _ => own,
        }
    }
}

/// The error that names a polynomial with a pole beyond the sampling.
fn beyond<const M: usize>(a: &[f32; M]) -> ConfigError {
    ConfigError::FilterPole {
        index: 0,
        value: a.first().copied().unwrap_or(0.0),
    }
}

/// X v of the state equations.
fn times<const M: usize>(v: &[f32; M], a: &[f32; M]) -> [f32; M] {
    let mut last = 0.0;
    for i in 0..M {
        last -= a[i] * v[i];
    }
    core::array::from_fn(|i| if i + 1 < M { v[i + 1] } else { last })
}

/// tanh(X)/X v.
fn tanh_ratio<const M: usize>(v: &[f32; M], a: &[f32; M]) -> [f32; M] {
    let mut power = *v;
    let mut sum = [0.0; M];
    for c in TANH {
        for (s, x) in sum.iter_mut().zip(power) {
            *s += c * x;
        }
        power = times(&times(&power, a), a);
    }
    sum
}

impl<const M: usize> TrendOperator<M> for ExactTrends<M> {
    type Memory = [f32; M];
    const EMPTY: [f32; M] = [0.0; M];

    fn sample_time(&self) -> f32 {
        self.chain.sample_time()
    }

    fn settled(&self, value: f32) -> [f32; M] {
        self.chain.settled(value)
    }

    fn settled_input(&self, value: f32, hold: Hold) -> [f32; M] {
        self.chain.settled_input(value, hold)
    }

    #[inline]
    fn output(&self, memory: &mut [f32; M], y: f32) -> Trends<M> {
        self.chain.output(memory, y)
    }

    #[inline(always)]
    fn movement(&self, memory: &mut [f32; M], y: f32, before: f32) -> Trends<M> {
        self.chain.movement(memory, y, before)
    }

    #[inline]
    fn input(&self, memory: &mut [f32; M], u: f32, hold: Hold) -> [f32; M] {
        let trends = self.chain.input(memory, u, hold);
        let (rows, direct) = match hold {
            Hold::Zero => (&self.zero, 0.0),
            Hold::First => (&self.first, u),
        };
        core::array::from_fn(|j| {
            let mut sum = self.direct[j] * direct;
            for i in 0..M {
                sum += rows[j][i] * trends[i];
            }
            sum
        })
    }

    fn lead(&self) -> Trends<M> {
        self.chain.lead()
    }

    fn gain(&self, bandwidth: f32) -> f32 {
        self.chain.gain(bandwidth)
    }

    fn filter_polynomial(&self) -> Option<[f32; M]> {
        self.chain.filter_polynomial()
    }

    fn noise_gain(&self) -> NoiseGain<M> {
        self.chain.noise_gain()
    }

    fn decay(&self) -> f32 {
        self.chain.decay()
    }

    fn continuous(&self, image: &[f32; M], integrators: usize) -> Option<Image<M>> {
        let a = to_continuous(image, self.sample_time())?;
        let numerator = self.numerator(&a, image, integrators);
        numerator.is_finite().then_some(Image { a, numerator })
    }

    fn sampled(&self, a: &[f32; M], integrators: usize) -> Option<Image<M>> {
        let image = to_gamma(a, self.sample_time())?;
        let numerator = 1.0 / self.numerator(a, &image, integrators);
        numerator.is_finite().then_some(Image {
            a: image,
            numerator,
        })
    }

    fn warm_up(&self) -> u32 {
        self.chain.warm_up()
    }
}
