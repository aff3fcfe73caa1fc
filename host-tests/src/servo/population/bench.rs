//! The axis in motion: dead time, wiring, sensor, jitter and missed slots, end stops.

use std::collections::VecDeque;

use crate::random::Random;
use rand::RngExt;

use crate::plants::pneumatic::PneumaticAxis;
use crate::plants::third_order::ThirdOrder;
use crate::servo::population::draw::{AxisDraw, Mechanics};
use crate::servo::population::range::{Purpose, stream};

/// Longest step of the integrator \[s\].
const STEP: f64 = 2e-4;

/// The drive of a bench.
#[derive(Clone, Debug)]
enum Drive {
    Pneumatic(Box<PneumaticAxis>),
    ThirdOrder(ThirdOrder),
}

impl Drive {
    fn position_mm(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.position_mm(),
            Self::ThirdOrder(drive) => drive.position_mm(),
        }
    }

    fn velocity_mm_s(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.velocity_mm_s(),
            Self::ThirdOrder(drive) => drive.velocity_mm_s(),
        }
    }

    fn advance(&mut self, u: f64, h: f64) {
        match self {
            Self::Pneumatic(axis) => axis.advance(u, h),
            Self::ThirdOrder(drive) => drive.advance(u, h),
        }
    }
}

/// An axis on the bench.
#[derive(Clone, Debug)]
pub struct Bench {
    drive: Drive,
    axis: AxisDraw,
    random: Random,
    /// Whether the valve is connected the wrong way round now.
    pub reversed: bool,
    /// Time \[s\], and that of the next sampling instant without jitter.
    time: f64,
    slot: f64,
    /// Commands on their way through the dead time, with the time of their arrival.
    pending: VecDeque<(f64, f64)>,
    command: f64,
    /// Hardest blow to an end stop so far \[mm/s\].
    pub blow_mm_s: f64,
}

impl Bench {
    /// An axis at rest at its start, wired as drawn.
    pub fn new(axis: &AxisDraw, purpose: Purpose) -> Self {
        let drive = match &axis.mechanics {
            Mechanics::Pneumatic(p) => Drive::Pneumatic(Box::new(PneumaticAxis::new(p, axis.seed))),
            Mechanics::ThirdOrder(p) => Drive::ThirdOrder(ThirdOrder::new(p)),
        };
        Self {
            drive,
            axis: *axis,
            random: stream(axis.seed, purpose),
            reversed: axis.reversed,
            time: 0.0,
            slot: 0.0,
            pending: VecDeque::new(),
            command: 0.0,
            blow_mm_s: 0.0,
        }
    }

    /// The axis.
    pub fn axis(&self) -> &AxisDraw {
        &self.axis
    }

    /// Time since the start \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The pneumatic axis, to change or break it.
    pub fn pneumatic_mut(&mut self) -> Option<&mut PneumaticAxis> {
        match &mut self.drive {
            Drive::Pneumatic(axis) => Some(axis),
            Drive::ThirdOrder(_) => None,
        }
    }

    /// Multiplies the moving mass; a constant load stays.
    pub fn multiply_mass(&mut self, factor: f64) {
        match &mut self.drive {
            Drive::Pneumatic(axis) => axis.set_mass(factor * axis.parameters().mass),
            Drive::ThirdOrder(drive) => drive.multiply_mass(factor),
        }
    }

    /// True position \[mm\].
    pub fn position_mm(&self) -> f64 {
        self.drive.position_mm()
    }

    /// Code of the sensor at the present instant.
    pub fn code(&mut self) -> i32 {
        let noise = self.axis.noise_mm * (2.0 * self.random.random::<f64>() - 1.0);
        ((self.position_mm() + noise) / self.axis.resolution_mm).round() as i32
    }

    /// Measured position \[mm\].
    pub fn measure_mm(&mut self) -> f64 {
        f64::from(self.code()) * self.axis.resolution_mm
    }

    /// Holds a command until the next sample: a sample time with jitter, two when the slot is
    /// missed.
    pub fn hold(&mut self, command: f64) {
        let signed = if self.reversed { -command } else { command };
        self.pending
            .push_back((self.time + self.axis.dead_time, signed));
        let missed = self.random.random::<f64>() < self.axis.missed;
        let late = self.axis.jitter * self.random.random::<f64>();
        self.slot += self.axis.sample_time * if missed { 2.0 } else { 1.0 };
        self.advance_to(self.slot + late * self.axis.sample_time);
    }

    fn advance_to(&mut self, end: f64) {
        while self.time < end {
            while let Some(&(arrival, command)) = self.pending.front()
                && arrival <= self.time
            {
                self.command = command;
                self.pending.pop_front();
            }
            let next = self.pending.front().map_or(end, |p| p.0.min(end));
            let steps = ((next - self.time) / STEP).ceil().max(1.0);
            let h = (next - self.time) / steps;
            for _ in 0..steps as u32 {
                self.step(h);
            }
            self.time = next;
        }
    }

    fn step(&mut self, h: f64) {
        let (before, speed) = (self.position_mm(), self.drive.velocity_mm_s().abs());
        self.drive.advance(self.command, h);
        let ends = [0.0, self.axis.stroke_mm()];
        let at = |x: f64| ends.iter().any(|end| (x - end).abs() < 1e-9);
        if at(self.position_mm()) && !at(before) {
            self.blow_mm_s = self.blow_mm_s.max(speed);
        }
    }
}
