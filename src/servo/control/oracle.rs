//! The loop at one frequency in double precision, by elimination instead of formulas.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::compensator::ScaledDrive;
use super::poles::Poles;

/// A complex number.
pub(super) type C = [f64; 2];

pub(super) fn times([a, b]: C, [c, d]: C) -> C {
    [a * c - b * d, a * d + b * c]
}

fn over(a: C, [c, d]: C) -> C {
    let size = c * c + d * d;
    times(a, [c / size, -d / size])
}

fn plus([a, b]: C, [c, d]: C) -> C {
    [a + c, b + d]
}

/// `e^(j angle)`.
pub(super) fn turn(angle: f64) -> C {
    [libm::cos(angle), libm::sin(angle)]
}

/// `matrix^-1 right`, by elimination with pivots.
fn solved<const N: usize>(mut matrix: [[C; N]; N], mut right: [C; N]) -> [C; N] {
    let size = |[a, b]: C| a * a + b * b;
    for k in 0..N {
        let pivot = (k..N)
            .max_by(|i, j| size(matrix[*i][k]).total_cmp(&size(matrix[*j][k])))
            .unwrap_or(k);
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        for i in (0..N).filter(|i| *i != k) {
            let [re, im] = over(matrix[i][k], matrix[k][k]);
            let factor = [-re, -im];
            for j in 0..N {
                matrix[i][j] = plus(matrix[i][j], times(factor, matrix[k][j]));
            }
            right[i] = plus(right[i], times(factor, right[k]));
        }
    }
    core::array::from_fn(|k| over(right[k], matrix[k][k]))
}

/// A controller on its drive: states x, v, p and the disturbance.
pub(super) struct Oracle {
    a: [[f64; 4]; 4],
    b0: f64,
    delay: f64,
    k: [f64; 4],
    l: [f64; 4],
}

impl Oracle {
    /// With gains that place these poles, found by comparing coefficients.
    pub(super) fn new(drive: &ScaledDrive, poles: &Poles, frequency: f32) -> Self {
        let [a1, a2, b0, delay] = [drive.a1, drive.a2, drive.b0, drive.delay].map(f64::from);
        let [c, z, o, d] = [
            poles.bandwidth,
            poles.damping,
            poles.observer,
            poles.disturbance,
        ]
        .map(f64::from);
        let w = c.max(frequency.into());
        let [p0, p1, p2] = [c * w * w, w * w + z * w * c, c + z * w];
        // s^3 + (a2 + k2) s^2 + (a1 + k1 + a2 k2) s + k0.
        let k2 = p2 - a2;
        let k1 = p1 - a1 - a2 * k2;
        // (s + o)^3 (s + d) of an observer that knows the position.
        let [q3, q2, q1, q0] = [
            3.0 * o + d,
            3.0 * o * o + 3.0 * o * d,
            o * o * o + 3.0 * o * o * d,
            o * o * o * d,
        ];
        let l1 = q3 - a2;
        let l2 = q2 - a1 - a2 * l1;
        // x' = v + l1, v' = p - a2 v + l2, p' = d - a1 v + l3, d' = l4.
        let l3 = q1 - a1 * l1;
        Self {
            a: [
                [0.0, 1.0, 0.0, 0.0],
                [0.0, -a2, 1.0, 0.0],
                [0.0, -a1, 0.0, 1.0],
                [0.0; 4],
            ],
            b0,
            delay,
            k: [p0, k1, k2, 1.0].map(|k| k / b0),
            l: [l1, l2, l3, q0],
        }
    }

    /// Gains of feedback times b0 and of the observer.
    pub(super) fn gains(&self) -> [[f64; 4]; 2] {
        [self.k.map(|k| k * self.b0), self.l]
    }

    /// `e^(A T) z` by 40 terms.
    fn transition(&self, z: [C; 4]) -> [C; 4] {
        let (mut sum, mut term) = (z, z);
        for n in 1..=40 {
            let share = self.delay / f64::from(n);
            term = core::array::from_fn(|i| {
                let of =
                    |part: usize| -> f64 { (0..4).map(|j| self.a[i][j] * term[j][part]).sum() };
                [share * of(0), share * of(1)]
            });
            sum = core::array::from_fn(|i| plus(sum[i], term[i]));
        }
        sum
    }

    /// `(s - A + L c)^-1 r`; with `l` of zero the drive itself.
    fn behind(&self, s: C, l: [f64; 4], r: [C; 4]) -> [C; 4] {
        let matrix = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let own = -self.a[i][j] + if j == 0 { l[i] } else { 0.0 };
                if i == j {
                    plus(s, [own, 0.0])
                } else {
                    [own, 0.0]
                }
            })
        });
        solved(matrix, r)
    }

    /// C of `f = -C y` at `w`.
    pub(super) fn at(&self, w: f64) -> C {
        let (s, late) = ([0.0, w], turn(-w * self.delay));
        let unit = [[0.0; 2], [0.0; 2], [self.b0, 0.0], [0.0; 2]];
        let read = |z: [C; 4]| {
            z.into_iter()
                .zip(self.k)
                .fold([0.0; 2], |sum, (z, k)| plus(sum, times([k, 0.0], z)))
        };
        let seen = self.behind(s, self.l, self.l.map(|l| [l, 0.0]));
        let through = read(self.transition(seen));
        let felt = self.behind(s, self.l, unit.map(|b| times(b, late)));
        let direct = read(self.transition(felt));
        // What the commands on their way will do: those of the last T seconds.
        let arrived = self.transition(unit).map(|b| times(b, late));
        let pending = core::array::from_fn(|i| plus(unit[i], times([-1.0, 0.0], arrived[i])));
        let pending = read(self.behind(s, [0.0; 4], pending));
        over(through, plus([1.0, 0.0], plus(direct, pending)))
    }
}

/// A drive with `late` more delay at `w`.
pub(super) fn response(drive: &ScaledDrive, w: f64, late: f64) -> C {
    let [a1, a2, b0, delay] = [drive.a1, drive.a2, drive.b0, drive.delay].map(f64::from);
    let own = times([0.0, w], [a1 - w * w, a2 * w]);
    over(times([b0, 0.0], turn(-w * (delay + late))), own)
}

/// Numbers without a pattern, from `low` to `high`.
pub(super) struct Dice(pub(super) u32);

impl Dice {
    pub(super) fn within(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        low + (self.0 >> 8) as f32 / 16_777_216.0 * (high - low)
    }

    /// A drive in its own time, and poles for it.
    pub(super) fn pair(&mut self) -> (ScaledDrive, Poles) {
        let drive = ScaledDrive {
            a1: self.within(0.8, 1.5),
            a2: self.within(0.2, 1.6),
            b0: self.within(0.5, 2.0),
            delay: self.within(0.0, 0.4),
        };
        let bandwidth = self.within(0.2, 2.0);
        let poles = Poles {
            bandwidth,
            damping: self.within(0.8, 1.6),
            observer: self.within(2.0, 6.0),
            disturbance: 0.3 * bandwidth,
        };
        (drive, poles)
    }
}
