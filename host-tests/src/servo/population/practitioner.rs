//! The fixed controller of a practitioner: position, velocity and acceleration feedback,
//! feedforward, inverse of the dead zone.

use crate::servo::population::draw::{AxisDraw, Limits};
use crate::servo::population::sequence::{Positioner, Sample};

/// What a practitioner turns until the axis runs well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Velocity per position error \[1/s\], over the natural frequency.
    pub position: f64,
    /// Velocity per velocity error.
    pub velocity: f64,
    /// The same of the acceleration, times the natural frequency.
    pub acceleration: f64,
    /// Poles of the filter that finds velocity and acceleration, over the natural frequency.
    pub filter: f64,
    /// Compensated part of the dead zone.
    pub dead_zone: f64,
    /// Flow over which the inverse of the dead zone changes sign.
    pub blend: f64,
}

/// The wanted motion: a polynomial from rest to rest, or a sine that grows and fades over a period.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reference {
    from: f64,
    to: f64,
    duration: f64,
    amplitude: f64,
    omega: f64,
    /// Time since the move, and since the sine began to grow or to fade.
    time: f64,
    growing: bool,
    phase: f64,
}

/// The polynomial from 0 to 1 with no velocity and acceleration at its ends, and its first three
/// derivatives.
fn blend(at: f64, duration: f64) -> [f64; 4] {
    if at >= duration {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let (s, d) = (at / duration, 1.0 / duration);
    [
        s * s * s * (10.0 - s * (15.0 - 6.0 * s)),
        30.0 * s * s * (1.0 - s) * (1.0 - s) * d,
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * d * d,
        60.0 * (1.0 - 6.0 * s + 6.0 * s * s) * d * d * d,
    ]
}

impl Reference {
    fn at(place: f64) -> Self {
        Self {
            from: place,
            to: place,
            duration: 0.0,
            amplitude: 0.0,
            omega: 1.0,
            time: 0.0,
            growing: false,
            phase: 0.0,
        }
    }

    /// Position and three derivatives.
    fn value(&self) -> [f64; 4] {
        if self.amplitude == 0.0 {
            let shape = blend(self.time, self.duration);
            let mut value = shape.map(|s| s * (self.to - self.from));
            value[0] += self.from;
            return value;
        }
        let mut weight = blend(self.time, std::f64::consts::TAU / self.omega);
        if !self.growing {
            weight = [1.0 - weight[0], -weight[1], -weight[2], -weight[3]];
        }
        let (sin, cos) = self.phase.sin_cos();
        let w = self.omega;
        let wave = [sin, w * cos, -w * w * sin, -w * w * w * cos];
        let product = [
            weight[0] * wave[0],
            weight[1] * wave[0] + weight[0] * wave[1],
            weight[2] * wave[0] + 2.0 * weight[1] * wave[1] + weight[0] * wave[2],
            weight[3] * wave[0]
                + 3.0 * (weight[2] * wave[1] + weight[1] * wave[2])
                + weight[0] * wave[3],
        ];
        let mut value = product.map(|p| p * self.amplitude);
        value[0] += self.to;
        value
    }

    fn resting(&self) -> bool {
        if self.amplitude == 0.0 {
            self.time >= self.duration
        } else {
            !self.growing && self.time >= std::f64::consts::TAU / self.omega
        }
    }
}

/// The controller in operation.
#[derive(Clone, Debug)]
pub struct Practitioner {
    /// k0, k1, k2 over b0, and a1, a2, 1 over b0.
    feedback: [f64; 3],
    feedforward: [f64; 3],
    dead_zone: f64,
    blend: f64,
    offset: f64,
    resolution: f64,
    dt: f64,
    limits: Limits,
    correction: [f64; 3],
    state: [f64; 3],
    reference: Reference,
}

impl Practitioner {
    /// A controller that knows the axis in the middle of its travel, its dead zone and offset; it
    /// starts at rest at a measured place \[mm\].
    pub fn new(axis: &AxisDraw, gains: &Gains, place_mm: f64) -> Self {
        let [c, w, xi] = axis.truth(0.5 * axis.stroke_mm());
        let [dead_zone, offset] = axis.valve_null();
        let dt = axis.sample_time;
        let pole = libm::exp(-gains.filter * w * dt);
        let rest = 1.0 - pole;
        Self {
            feedback: [
                gains.position * w / c,
                gains.velocity / c,
                gains.acceleration / (w * c),
            ],
            feedforward: [1.0 / c, 2.0 * xi / (w * c), 1.0 / (w * w * c)],
            dead_zone: gains.dead_zone * dead_zone,
            blend: gains.blend,
            offset,
            resolution: axis.resolution_mm,
            dt,
            limits: axis.limits(),
            correction: [
                1.0 - pole * pole * pole,
                1.5 * rest * rest * (1.0 + pole) / dt,
                rest * rest * rest / (dt * dt),
            ],
            state: [place_mm, 0.0, 0.0],
            reference: Reference::at(place_mm),
        }
    }

    /// Position, velocity and acceleration: an alpha-beta-gamma filter with three equal poles.
    fn estimate(&mut self, y: f64) -> [f64; 3] {
        let dt = self.dt;
        let [x, v, a] = self.state;
        let predicted = x + dt * (v + 0.5 * dt * a);
        let miss = y - predicted;
        let [alpha, beta, gamma] = self.correction;
        self.state = [
            predicted + alpha * miss,
            v + dt * a + beta * miss,
            a + gamma * miss,
        ];
        self.state
    }
}

impl Positioner for Practitioner {
    fn move_to(&mut self, target_mm: f64) {
        let r = &mut self.reference;
        if r.amplitude != 0.0 && r.growing {
            // A sine fades about its centre.
            r.growing = false;
            r.time = 0.0;
            return;
        }
        let from = r.value()[0];
        let distance = (target_mm - from).abs();
        // Largest derivatives of the polynomial: 15/8, 10/sqrt(3) and 60 times distance over powers
        // of the duration.
        let duration = (1.875 * distance / self.limits.velocity)
            .max((5.7735 * distance / self.limits.acceleration).sqrt())
            .max((60.0 * distance / self.limits.jerk).cbrt());
        *r = Reference {
            from,
            to: target_mm,
            duration,
            ..Reference::at(from)
        };
    }

    fn oscillate(&mut self, amplitude_mm: f64, frequency_hz: f64) -> bool {
        let place = self.reference.value()[0];
        self.reference = Reference {
            amplitude: amplitude_mm,
            omega: std::f64::consts::TAU * frequency_hz,
            growing: true,
            ..Reference::at(place)
        };
        true
    }

    fn update(&mut self, code: i32) -> Sample {
        let [x, v, a] = self.estimate(f64::from(code) * self.resolution);
        let [r0, r1, r2, r3] = self.reference.value();
        let [k0, k1, k2] = self.feedback;
        let [f1, f2, f3] = self.feedforward;
        let flow = f1 * r1 + f2 * r2 + f3 * r3 + k0 * (r0 - x) + k1 * (r1 - v) + k2 * (r2 - a);
        let command = flow + self.dead_zone * (flow / self.blend).clamp(-1.0, 1.0) - self.offset;
        let sample = Sample {
            reference_mm: r0,
            resting: self.reference.resting(),
            command: command.clamp(-1.0, 1.0),
            alive: true,
            moves_at_rest: 0,
        };
        self.reference.time += self.dt;
        self.reference.phase += self.reference.omega * self.dt;
        sample
    }
}
