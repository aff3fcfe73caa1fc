//! A drive of third order with friction that sticks, between end stops, behind a valve: velocity
//! drives, hydraulics.
//!
//! ```text
//! x' = v    v' = p + load - a2 v - friction    p' = b0 (q - imbalance |q|) - a1 v - leak p
//! ```
//!
//! All forces are per mass. The spool follows the command as a lag of second order, q is the flow
//! of a [`StaticValve`]. Integrated by Runge-Kutta of order 4; a reversal or an end stop ends a
//! step at rest, so that events are as fine as the step.

use crate::plants::pneumatic::Friction;
use crate::plants::valve::StaticValve;

/// Numbers of the drive, in mm and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThirdOrderParameters {
    /// Velocity gain C \[mm/s per unit of flow\].
    pub gain: f64,
    /// Natural frequency \[rad/s\].
    pub omega0: f64,
    /// Damping.
    pub xi: f64,
    /// Rate at which the drive force leaks away \[1/s\].
    pub leak: f64,
    /// Largest drive force per mass: the supply is no larger \[mm/s2\].
    pub force_max: f64,
    /// Constant force per mass toward larger positions \[mm/s2\].
    pub load: f64,
    /// Friction per mass, in mm and s, viscous part excluded.
    pub friction: Friction,
    /// Share of the flow that is missing towards larger positions, and that there is more of
    /// towards smaller ones.
    pub imbalance: f64,
    /// Travel between the end stops \[mm\].
    pub stroke: f64,
    /// The valve.
    pub valve: StaticValve,
    /// Natural frequency of the spool \[rad/s\].
    pub spool_frequency: f64,
    /// Damping of the spool.
    pub spool_damping: f64,
    /// Position at the start \[mm\].
    pub start: f64,
}

/// Position, velocity, force per mass, spool and its rate.
type State = [f64; 5];

/// The drive in motion.
#[derive(Clone, Debug)]
pub struct ThirdOrder {
    p: ThirdOrderParameters,
    state: State,
}

impl ThirdOrder {
    /// A drive at rest at its start, in balance with its load.
    pub fn new(p: &ThirdOrderParameters) -> Self {
        Self {
            p: *p,
            state: [p.start, 0.0, -p.load, 0.0, 0.0],
        }
    }

    /// True position \[mm\].
    pub fn position_mm(&self) -> f64 {
        self.state[0]
    }

    /// True velocity \[mm/s\].
    pub fn velocity_mm_s(&self) -> f64 {
        self.state[1]
    }

    /// Changes the constant force per mass \[mm/s2\].
    pub fn set_load(&mut self, load: f64) {
        self.p.load = load;
    }

    /// Multiplies the moving mass: what is stated per mass, the stiffness and the force in the
    /// drive fall by the factor.
    pub fn multiply_mass(&mut self, factor: f64) {
        let p = &mut self.p;
        let root = factor.sqrt();
        p.omega0 /= root;
        p.xi /= root;
        p.force_max /= factor;
        p.load /= factor;
        p.friction = p.friction.scaled(1.0 / factor);
        self.state[2] /= factor;
    }

    fn derivative(&self, s: &State, command: f64, direction: f64) -> State {
        let p = &self.p;
        let [_, v, force, spool, rate] = *s;
        let a1 = p.omega0 * p.omega0;
        let acceleration =
            force + p.load - 2.0 * p.xi * p.omega0 * v - p.friction.force(v, direction);
        let w = p.spool_frequency;
        let flow = p.valve.flow(spool);
        let arrives = flow - p.imbalance * flow.abs();
        let moving = f64::from(direction != 0.0);
        [
            moving * v,
            moving * acceleration,
            p.gain * a1 * arrives - a1 * moving * v - p.leak * force,
            rate,
            w * (w * (command - spool) - 2.0 * p.spool_damping * rate),
        ]
    }

    /// Holds the command `u` (limited to -1..1) for `h` seconds: one step of the integrator.
    pub fn advance(&mut self, u: f64, h: f64) {
        let (u, s) = (u.clamp(-1.0, 1.0), self.state);
        let direction = self.direction();
        let plus = |h: f64, d: &State| std::array::from_fn(|i| s[i] + h * d[i]);
        let k1 = self.derivative(&s, u, direction);
        let k2 = self.derivative(&plus(0.5 * h, &k1), u, direction);
        let k3 = self.derivative(&plus(0.5 * h, &k2), u, direction);
        let k4 = self.derivative(&plus(h, &k3), u, direction);
        let mean: State = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        self.state = plus(h, &mean);
        self.state[2] = self.state[2].clamp(-self.p.force_max, self.p.force_max);
        let inside = self.state[0].clamp(0.0, self.p.stroke);
        let rests = self.p.friction.breakaway > 0.0 && self.state[1] * direction <= 0.0;
        if rests || inside != self.state[0] {
            self.state[0] = inside;
            self.state[1] = 0.0;
        }
    }

    /// Direction of the motion in the next step; 0 while friction or an end stop holds the drive.
    fn direction(&self) -> f64 {
        let [x, v, force, ..] = self.state;
        if v != 0.0 {
            return v.signum();
        }
        let direction = self.p.friction.start(force + self.p.load);
        let outward = (direction > 0.0 && x >= self.p.stroke) || (direction < 0.0 && x <= 0.0);
        if outward { 0.0 } else { direction }
    }
}
