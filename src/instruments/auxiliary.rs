//! The inputs filtered once more, by a fixed auxiliary denominator.
//!
//! ```text
//! x_j = s^j / (A_f A_z) u          j = 0 .. q + k        A_z: the q fastest poles of A_f, in units of the bandwidth
//! ```
//!
//! The trend of order 0 of u is `u / A_f`; a chain of q trapezoidal integrators with the feedback
//! of A_z makes x_0 .. x_q of it, and `s^q = A_z - sum z_i s^i` what is above. The trapezoids need
//! not be exact: instruments may be any function of the inputs.

use crate::math::complex::Complex;
use crate::math::roots::roots;
use crate::math::sqrt;

/// The coefficients of A_z with its integrators behind it, at the places `first` to `M - 1` of
/// polynomials of order M.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Auxiliary<const M: usize> {
    /// The order of A_z is `M - first`.
    first: usize,
    /// z_i at the place `first + i`, in powers of the bandwidth.
    denominator: [f32; M],
    /// Half a sample time, in units of 1/bandwidth.
    half: f32,
    /// 1 / (1 + sum z_i half^(q-i)).
    loop_gain: f32,
}

/// States below this change no digit of any sum.
const NEGLIGIBLE: f32 = 1e-25;

impl<const M: usize> Auxiliary<M> {
    /// The fast part of `filter` (f_0 .. f_{m-1}); `None` where its poles are not found.
    pub(crate) fn new(
        filter: &[f32; M],
        integrators: usize,
        bandwidth: f32,
        sample_time: f32,
    ) -> Option<Self> {
        let mut poles = [Complex::ZERO; M];
        roots(filter, &mut poles)?;
        let mut denominator = [0.0; M];
        // A pair of which the integrators have taken one pole leaves a real pole of its size.
        let chosen = poles.iter().skip(integrators);
        let mut alone = chosen.filter(|pole| pole.im != 0.0).count() % 2 == 1;
        let mut product = [Complex::ZERO; M];
        for (order, pole) in poles.iter().skip(integrators).enumerate() {
            let size = -sqrt(pole.re * pole.re + pole.im * pole.im) / bandwidth;
            let scaled = match alone && pole.im != 0.0 {
                true => Complex { re: size, im: 0.0 },
                false => Complex {
                    re: pole.re / bandwidth,
                    im: pole.im / bandwidth,
                },
            };
            alone = alone && pole.im == 0.0;
            multiply(&mut product, order, scaled);
        }
        for (slot, value) in denominator.iter_mut().skip(integrators).zip(&product) {
            *slot = value.re;
        }
        let half = 0.5 * bandwidth * sample_time;
        let (mut sum, mut weight) = (1.0, half);
        for value in denominator.iter().skip(integrators).rev() {
            sum += value * weight;
            weight *= half;
        }
        let loop_gain = 1.0 / sum;
        (loop_gain.is_finite() && loop_gain > 0.0).then_some(Self {
            first: integrators,
            denominator,
            half,
            loop_gain,
        })
    }

    /// The states at rest under the trend `value` of order 0.
    fn at_rest(&self, value: f32) -> [f32; M] {
        let mut states = [0.0; M];
        if let (Some(state), Some(lowest)) =
            (states.get_mut(self.first), self.denominator.get(self.first))
        {
            *state = value / lowest;
        }
        states
    }

    /// Takes the normalised trends of an input, gives the rows x_0, x_1, ..
    #[inline(always)]
    fn step(&self, states: &mut [f32; M], trends: &[f32; M], rows: &mut [f32]) {
        // Each order by itself: loops of known length.
        match self.first {
            0 => self.step_from(0, states, trends, rows),
            1 => self.step_from(1, states, trends, rows),
            first => self.step_from(first, states, trends, rows),
        }
    }

    #[inline(always)]
    fn step_from(&self, first: usize, states: &mut [f32; M], trends: &[f32; M], rows: &mut [f32]) {
        let mut known = *states;
        for i in (0..M - 1).rev() {
            if i >= first {
                known[i] += self.half * known[i + 1];
            }
        }
        let mut top = trends[0];
        for i in 0..M {
            if i >= first {
                top -= self.denominator[i] * known[i];
            }
        }
        top *= self.loop_gain;
        let mut above = top;
        for i in (0..M).rev() {
            if i >= first {
                let share = self.half * above;
                let lower = states[i] + share;
                states[i] = lower + share;
                known[i] = lower;
                above = lower;
            }
        }
        let mut row = rows.iter_mut();
        for i in 0..M {
            if i >= first
                && let Some(row) = row.next()
            {
                *row = known[i];
            }
        }
        if let Some(row) = row.next() {
            *row = top;
            self.higher(first, trends, rows);
        }
    }

    /// x_(q+k) = s^k u / A_f - sum z_i x_(i+k), for k from 1 on.
    #[inline(never)]
    fn higher(&self, first: usize, trends: &[f32; M], rows: &mut [f32]) {
        let order = M - first;
        for k in 1..M {
            let mut value = trends[k];
            for i in 0..order {
                let weight = self.denominator.get(first + i).copied().unwrap_or(0.0);
                value -= weight * rows.get(i + k).copied().unwrap_or(0.0);
            }
            if let Some(row) = rows.get_mut(order + k) {
                *row = value;
            }
        }
    }
}

/// Multiplies a monic polynomial of order `order` by (s - root).
fn multiply<const M: usize>(product: &mut [Complex; M], order: usize, root: Complex) {
    let minus = Complex {
        re: -root.re,
        im: -root.im,
    };
    let mut below = Complex::ZERO;
    for (i, value) in product.iter_mut().enumerate().take(order + 1) {
        let this = if i == order { Complex::ONE } else { *value };
        let times = this.times(minus);
        *value = Complex {
            re: times.re + below.re,
            im: times.im + below.im,
        };
        below = this;
    }
}

/// The auxiliary filter of one input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lane<const M: usize> {
    states: [f32; M],
    /// One over the size of the trend of each order.
    scales: [f32; M],
    /// Begins at rest with the next trends.
    fresh: bool,
}

impl<const M: usize> Lane<M> {
    /// A lane for an input of this size; `top` is the size of the trend of order m of a signal of
    /// size 1.
    pub(crate) fn new(range: f32, top: f32, bandwidth: f32) -> Self {
        let mut scales = [0.0; M];
        let mut size = top * range;
        for scale in scales.iter_mut().rev() {
            size /= bandwidth;
            *scale = 1.0 / size;
        }
        Self {
            states: [0.0; M],
            scales,
            fresh: true,
        }
    }

    /// As constructed.
    pub(crate) fn reset(&mut self) {
        self.states = [0.0; M];
        self.fresh = true;
    }

    /// Begins at rest with the next trends.
    pub(crate) fn begin(&mut self) {
        self.fresh = true;
    }

    /// Takes the trends of the input, gives its rows.
    #[inline(always)]
    pub(crate) fn update(&mut self, auxiliary: &Auxiliary<M>, trends: &[f32; M], rows: &mut [f32]) {
        let mut scaled = *trends;
        for (value, scale) in scaled.iter_mut().zip(&self.scales) {
            *value *= scale;
        }
        if self.fresh {
            self.states = auxiliary.at_rest(scaled[0]);
            self.fresh = false;
        }
        auxiliary.step(&mut self.states, &scaled, rows);
    }

    /// Sets what has decayed beyond any use to zero, before it becomes subnormal.
    #[inline(never)]
    pub(crate) fn flush(&mut self) {
        for state in &mut self.states {
            if state.abs() < NEGLIGIBLE {
                *state = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_part_of_a_filter() {
        // (s + 2.2)(s^2 + 30.8 s + 484), in units of 20 rad/s: s^2 + 1.54 s + 1.21.
        let filter = [1064.8, 551.76, 33.0];
        let servo = Auxiliary::<3>::new(&filter, 1, 20.0, 1e-3).unwrap();
        assert_eq!(servo.first, 1);
        assert!((servo.denominator[1] - 1.21).abs() < 1e-4);
        assert!((servo.denominator[2] - 1.54).abs() < 1e-4);
        // Two integrators take one pole of the pair: its size remains.
        let double = Auxiliary::<3>::new(&filter, 2, 20.0, 1e-3).unwrap();
        assert!((double.denominator[2] - 1.1).abs() < 1e-4);
        let all = Auxiliary::<3>::new(&filter, 0, 20.0, 1e-3).unwrap();
        assert!((all.denominator[0] - 1064.8 / 8000.0).abs() < 1e-4);
    }

    /// A ramp of trends through `1/(s + 1)` and its derivatives, in units of the bandwidth.
    #[test]
    fn the_rows_are_derivatives_of_each_other() {
        let auxiliary = Auxiliary::<2>::new(&[400.0, 40.0], 0, 20.0, 1e-3).unwrap();
        let mut lane = Lane::<2>::new(1.0, 1.0, 20.0);
        lane.begin();
        let mut rows = [0.0_f32; 4];
        let mut before = [0.0_f32; 4];
        for k in 0..3000 {
            let t = 1e-3 * k as f32;
            // u_0 = sin(3 t) / 400 and its derivative.
            let trends = [(3.0 * t).sin() / 400.0, 3.0 * (3.0 * t).cos() / 400.0];
            before.copy_from_slice(&rows);
            lane.update(&auxiliary, &trends, &mut rows);
            if k > 2000 {
                for j in 0..3 {
                    // In units of the bandwidth: a sample time is 0.02.
                    let slope = (rows[j] - before[j]) / 0.02;
                    let mean = 0.5 * (rows[j + 1] + before[j + 1]);
                    assert!((slope - mean).abs() < 2e-4, "{j}: {slope} {mean}");
                }
            }
        }
        // 1/(1 + 0.15j)^2 of the sine.
        assert!(rows[0].abs() < 1.0 && rows[0].abs() > 0.01);
    }
}
