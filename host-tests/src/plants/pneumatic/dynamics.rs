//! The differential equations and their integrator.
//!
//! Between events (stop, start, end stop) the right-hand side is smooth in pieces and classical
//! Runge-Kutta of order 4 with a fixed step follows it. An event inside a step is located by linear
//! interpolation and the step is cut there.

use super::flow::{AIR, mass_flow};
use super::parameters::{AMBIENT, AxisParameters};

/// Continuous state in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    /// Position from the stop on the side of chamber A \[m\].
    pub x: f64,
    /// Velocity \[m/s\].
    pub v: f64,
    /// Absolute pressure of chamber A \[Pa\].
    pub pa: f64,
    /// Absolute pressure of chamber B \[Pa\].
    pub pb: f64,
    /// Position of the spool, -1..1.
    pub spool: f64,
    /// Velocity of the spool \[1/s\].
    pub rate: f64,
}

impl State {
    fn plus(&self, h: f64, d: &Self) -> Self {
        Self {
            x: self.x + h * d.x,
            v: self.v + h * d.v,
            pa: self.pa + h * d.pa,
            pb: self.pb + h * d.pb,
            spool: self.spool + h * d.spool,
            rate: self.rate + h * d.rate,
        }
    }
}

/// The equations with all constants worked out.
#[derive(Clone, Debug)]
pub(super) struct Dynamics {
    p: AxisParameters,
    area_a: f64,
    area_b: f64,
    area_rod: f64,
    supply: f64,
}

/// Flow opening of the valve for a spool position, -1..1 times the gain.
pub(super) fn opening(p: &AxisParameters, spool: f64) -> f64 {
    let at = spool + p.offset;
    let beyond = (at.abs() - p.dead_zone).clamp(0.0, 1.0);
    p.valve_gain * beyond * at.signum()
}

impl Dynamics {
    pub(super) fn new(p: &AxisParameters) -> Self {
        Self {
            p: *p,
            area_a: p.area_a(),
            area_b: p.area_b(),
            area_rod: p.area_a() - p.area_b(),
            supply: p.supply(),
        }
    }

    /// Pressure force on the piston \[N\].
    pub(super) fn force(&self, s: &State) -> f64 {
        self.area_a * s.pa - self.area_b * s.pb - self.area_rod * AMBIENT
    }

    /// Time derivative while the axis moves in `direction`; 0 means that it is held.
    fn derivative(&self, s: &State, command: f64, direction: f64) -> State {
        let p = &self.p;
        let flow =
            |c: f64, p1: f64, p2: f64| mass_flow(c, p.critical_ratio, p.linear_ratio, p1, p2);
        let open = opening(p, s.spool);
        let leak = p.valve_leakage * p.conductance;
        // Edges supply -> A and B -> ambient open together, as do supply -> B and A -> ambient.
        let forward = leak + p.conductance * open.max(0.0);
        let backward = leak + p.conductance * (-open).max(0.0);
        let mut qa = flow(forward, self.supply, s.pa) - flow(backward, s.pa, AMBIENT);
        let mut qb = flow(backward, self.supply, s.pb) - flow(forward, s.pb, AMBIENT);
        if p.piston_leakage > 0.0 {
            let across = flow(p.piston_leakage * p.conductance, s.pa, s.pb);
            qa -= across;
            qb += across;
        }
        let (v, acceleration) = if direction == 0.0 {
            (0.0, 0.0)
        } else {
            let net = self.force(s) + p.load - p.friction.force(s.v, direction);
            (s.v, net / p.mass)
        };
        let [va, vb] = p.volumes(s.x);
        let w = p.spool_frequency;
        State {
            x: v,
            v: acceleration,
            pa: p.polytropic / va * (AIR * qa - s.pa * self.area_a * v),
            pb: p.polytropic / vb * (AIR * qb + s.pb * self.area_b * v),
            spool: s.rate,
            rate: w * (w * (command - s.spool) - 2.0 * p.spool_damping * s.rate),
        }
    }

    fn runge_kutta(&self, s: &State, command: f64, direction: f64, h: f64) -> State {
        let k1 = self.derivative(s, command, direction);
        let k2 = self.derivative(&s.plus(0.5 * h, &k1), command, direction);
        let k3 = self.derivative(&s.plus(0.5 * h, &k2), command, direction);
        let k4 = self.derivative(&s.plus(h, &k3), command, direction);
        s.plus(h / 6.0, &k1)
            .plus(h / 3.0, &k2)
            .plus(h / 3.0, &k3)
            .plus(h / 6.0, &k4)
    }

    /// Direction in which the axis goes on from rest: 0 while friction or an end stop holds it.
    fn start(&self, s: &State) -> f64 {
        let direction = self.p.friction.start(self.force(s) + self.p.load);
        let outward = (direction > 0.0 && s.x >= self.p.stroke) || (direction < 0.0 && s.x <= 0.0);
        if outward { 0.0 } else { direction }
    }

    /// Fraction of the step from `s` to `end` after which the axis turns or meets the stop ahead,
    /// and that stop.
    fn event(&self, s: &State, end: &State, direction: f64) -> Option<(f64, Option<f64>)> {
        let turns = end.v * direction <= 0.0;
        let outside = end.x < 0.0 || end.x > self.p.stroke;
        if !turns && !outside {
            return None;
        }
        // The earlier one counts.
        let stop = if direction > 0.0 { self.p.stroke } else { 0.0 };
        let turn = if turns { s.v / (s.v - end.v) } else { 1.0 };
        let strike = if outside {
            (stop - s.x) / (end.x - s.x)
        } else {
            f64::INFINITY
        };
        let part = turn.min(strike);
        let part = if part.is_finite() {
            part.clamp(0.0, 1.0)
        } else {
            0.0
        };
        Some((part, (strike <= turn).then_some(stop)))
    }

    /// Advances by `h` with a held command. `blocked` clamps the axis where it is.
    pub(super) fn advance(&self, s: &mut State, command: f64, h: f64, blocked: bool) {
        let mut left = h;
        // A step meets a few events at most; should it meet more, the axis is held for the rest of
        // the step.
        for _ in 0..4 {
            let direction = if blocked {
                0.0
            } else if s.v != 0.0 {
                s.v.signum()
            } else {
                self.start(s)
            };
            let end = self.runge_kutta(s, command, direction, left);
            if direction == 0.0 {
                *s = State {
                    x: s.x,
                    v: 0.0,
                    ..end
                };
                return;
            }
            let Some((part, stop)) = self.event(s, &end, direction) else {
                *s = end;
                return;
            };
            let until = self.runge_kutta(s, command, direction, part * left);
            // Impacts at the end stops are inelastic, so that both events end at rest.
            *s = State {
                x: stop.unwrap_or(until.x.clamp(0.0, self.p.stroke)),
                v: 0.0,
                ..until
            };
            left -= part * left;
            if part == 0.0 || left <= 0.0 {
                break;
            }
        }
        if left > 0.0 {
            let end = self.runge_kutta(s, command, 0.0, left);
            *s = State {
                x: s.x,
                v: 0.0,
                ..end
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Friction, Linearised};
    use super::*;

    /// A sealed axis without friction: two air springs and a mass.
    const SEALED: AxisParameters = AxisParameters {
        friction: Friction::NONE,
        valve_leakage: 0.0,
        piston_leakage: 0.0,
        ..AxisParameters::SERVO
    };

    fn at_rest(x: f64) -> State {
        State {
            x,
            v: 0.0,
            pa: 5.3e5,
            pb: 5.3e5,
            spool: 0.0,
            rate: 0.0,
        }
    }

    #[test]
    fn sealed_air_keeps_its_invariants() {
        let dynamics = Dynamics::new(&SEALED);
        let mut s = State {
            v: 1.0,
            ..at_rest(0.15)
        };
        let n = SEALED.polytropic;
        let invariants = |s: &State| {
            let [va, vb] = SEALED.volumes(s.x);
            // A polytropic gas without flow: p V^n, and kinetic plus spring energy p V / (n - 1).
            let energy = 0.5 * SEALED.mass * s.v * s.v + (s.pa * va + s.pb * vb) / (n - 1.0);
            [s.pa * va.powf(n), s.pb * vb.powf(n), energy]
        };
        let before = invariants(&s);
        for _ in 0..20_000 {
            dynamics.advance(&mut s, 0.0, 5e-5, false);
        }
        for (a, b) in invariants(&s).iter().zip(before) {
            assert!((a / b - 1.0).abs() < 1e-8, "{a} after 1 s, {b} before");
        }
    }

    #[test]
    fn small_oscillations_have_the_linear_frequency() {
        for x in [0.05, 0.2, 0.3] {
            let dynamics = Dynamics::new(&SEALED);
            let balance = super::super::flow::balance(
                SEALED.critical_ratio,
                SEALED.linear_ratio,
                SEALED.supply(),
                AMBIENT,
            );
            let mut s = State {
                v: 1e-3,
                pa: balance,
                pb: balance,
                ..at_rest(x)
            };
            let h = 1e-5;
            let mut crossings = Vec::new();
            for k in 0..200_000 {
                let before = s;
                dynamics.advance(&mut s, 0.0, h, false);
                if before.x < x && s.x >= x {
                    let part = (x - before.x) / (s.x - before.x);
                    crossings.push(h * (f64::from(k) + part));
                }
            }
            let periods = (crossings.len() - 1) as f64;
            let measured =
                periods * std::f64::consts::TAU / (crossings.last().unwrap() - crossings[0]);
            let omega0 = Linearised::new(&SEALED, 1e3 * x, 0.0).omega0;
            assert!(
                (measured / omega0 - 1.0).abs() < 1e-5,
                "{measured} instead of {omega0} rad/s at {x} m"
            );
        }
    }

    #[test]
    fn spool_follows_its_closed_form() {
        let dynamics = Dynamics::new(&AxisParameters::SERVO);
        let mut s = at_rest(0.2);
        let (w, z) = (628.0_f64, 0.7_f64);
        let wd = w * (1.0 - z * z).sqrt();
        for k in 1..=400 {
            dynamics.advance(&mut s, 0.5, 5e-5, true);
            let t = 5e-5 * f64::from(k);
            let step = 1.0 - (-z * w * t).exp() * ((wd * t).cos() + z * w / wd * (wd * t).sin());
            assert!((s.spool - 0.5 * step).abs() < 1e-8, "{} at {t} s", s.spool);
        }
    }
}
