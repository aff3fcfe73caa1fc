//! The command that holds an axis at rest, bracketed by its slips.

use crate::math::within;

/// Largest flow that slips show, and the farthest command beyond the dead zone.
const SHOWN: f32 = 0.02;
const MOST: f32 = 0.05;
/// Distance from the edge of the dead zone, inwards, at which the search for a command beyond it
/// begins.
const EDGE: f32 = 0.02;
/// Factor on a flow that was shown, after another one the same way and after one the other way; and
/// its bounds.
const SAME: f32 = 1.5;
const OTHER: f32 = 0.5;
const FACTOR: [f32; 2] = [0.1, 4.0];
/// Commands that slipped both ways and are closer than this bracket nothing: what they should hold
/// has changed.
const BETWEEN: f32 = 0.004;

/// The axis leaves its rest: friction that held it lets go, or nothing holds it and it creeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slip {
    /// 1 or -1.
    pub(crate) direction: f32,
    /// Way of the drive to the edge of friction, over b0; of an axis that nothing holds, its own
    /// way over C: time in s in which the full flow leads so far.
    pub(crate) way: f32,
    /// Time in s for which what came before the rest acts on: an earlier slip says nothing.
    pub(crate) settled: f32,
}

/// The valve, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edges {
    /// Command in the middle of the dead zone, and half of its width.
    pub(crate) middle: f32,
    pub(crate) dead_zone: f32,
}

/// Command of the valve at rest.
///
/// While friction holds the axis its drive goes on by `b0 q`, unseen, where q, the flow through the
/// valve and its leaks, grows with the command c; the axis slips when the drive has come to the
/// edge of what friction holds. So a slip tells on which side of the command that holds the axis c
/// was, whatever the valve and its leaks are: upward, c was too large; downward, too small.
///
/// ```text
/// slipped both ways, more than 0.004 apart:  c <- half of their sum                                       bisection
/// always one way, deep in the dead zone:     c <- 0.02 within its edge: inside, q depends on c hardly
/// one way, near the edge and beyond it:      c <- c - direction factor q,   q = way / time
/// ```
///
/// Bisection halves the bracket with each slip and asks nothing of q but that it grows. The step
/// before there is a bracket takes q from the times between slips; its factor grows while they go
/// the same way, since nobody knows the width of the dead zone, and is halved after one the other
/// way. A bound that is contradicted, because the load, the place or the supply is another one, is
/// forgotten, and the search goes on from where it is. The command stays within 0.05 of the dead
/// zone, which is what the monitors take a valve to be wrong by.
///
/// An axis that stopped near its breakaway slips early, whatever q is, and one that nothing holds
/// may be swung out of its window: the rests and the ways of slips in one direction are added up
/// until they outlast what came before them, and count as one.
///
/// Without it an axis with gravity and a leak slips from its rest again and again, and the loop
/// brings it back: a cycle that no window ends, because the drive drifts and does not hunt. An axis
/// without friction creeps from it, where it is the position that goes on by `C q`: the same search
/// ends that, too.
///
/// Known as: bisection; before it, accelerated stochastic approximation (Kesten 1958).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Holding {
    /// The command; `None`: that of the middle.
    command: Option<f32>,
    factor: f32,
    /// Commands that slipped downward and upward.
    slipped: [Option<f32>; 2],
    /// Whether it ever slipped both ways.
    bracketed: bool,
    /// Direction of the latest slip, or creep, that counted.
    last: f32,
    /// Time in s for which the valve at rest has held the axis.
    time: f32,
    /// Direction of the slips that are added up, their times at rest and their ways.
    run: f32,
    rested: f32,
    way: f32,
}

impl Holding {
    /// Nothing is known.
    pub(crate) const NONE: Self = Self {
        command: None,
        factor: 1.0,
        slipped: [None; 2],
        bracketed: false,
        last: 0.0,
        time: 0.0,
        run: 0.0,
        rested: 0.0,
        way: 0.0,
    };

    /// One sample; `holds`: the valve is at rest, and holds the axis.
    #[inline]
    pub(crate) fn pass(&mut self, sample_time: f32, holds: bool) {
        self.time = if holds { self.time + sample_time } else { 0.0 };
    }

    /// The axis slips; from motion, that shows nothing.
    #[inline]
    pub(crate) fn slip(&mut self, slip: &Slip, valve: &Edges) {
        if !(self.time > 0.0) {
            return;
        }
        let direction = slip.direction;
        if !(direction * self.run > 0.0) {
            (self.way, self.rested) = (0.0, 0.0);
        }
        self.run = direction;
        self.way += slip.way;
        self.rested += self.time;
        self.time = 0.0;
        if self.rested > slip.settled {
            let flow = self.way / self.rested;
            (self.way, self.rested) = (0.0, 0.0);
            self.shown(direction, flow, valve);
        }
    }

    /// The command lets so much flow too much through in a direction.
    fn shown(&mut self, direction: f32, flow: f32, valve: &Edges) {
        let Edges { middle, dead_zone } = *valve;
        let turn = match direction * self.last {
            0.0 => 1.0,
            same if same > 0.0 => SAME,
            _ => OTHER,
        };
        self.last = direction;
        let command = self.command.unwrap_or(middle);
        let side = usize::from(direction > 0.0);
        self.bracketed |= self.slipped[1 - side].is_some();
        self.slipped[side] = Some(command);
        let other = self.slipped[1 - side].filter(|&other| direction * (command - other) > BETWEEN);
        self.slipped[1 - side] = other;
        let inside = dead_zone - EDGE;
        let next = if let Some(other) = other {
            self.factor = 1.0;
            0.5 * (command + other)
        } else if !self.bracketed && (command - middle).abs() < inside - 0.5 * EDGE {
            middle - direction * inside
        } else {
            let [least, most] = FACTOR;
            let factor = self.factor * turn;
            let factor = if factor < most { factor } else { most };
            self.factor = if factor > least { factor } else { least };
            command - direction * self.factor * within(flow, SHOWN)
        };
        self.command = Some(middle + within(next - middle, dead_zone + MOST));
    }

    /// Whether the axis has ever slipped from its rest.
    pub(crate) fn has_slipped(&self) -> bool {
        self.run != 0.0
    }

    /// The command; `None`: that of the middle.
    pub(crate) const fn command(&self) -> Option<f32> {
        self.command
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: Edges = Edges {
        middle: 0.0,
        dead_zone: 0.05,
    };

    /// Ways over b0 of a drive from the middle of friction to its edge, and over C of an axis that
    /// nothing holds to that of its window.
    const FRICTION: f32 = 0.004;
    const WINDOW: f32 = 2e-4;

    fn slip(direction: f32, way: f32) -> Slip {
        Slip {
            direction,
            way,
            settled: 0.02,
        }
    }

    /// Slips in the first and in the last 30 s of 60 s in which `flow + load` moves a drive, or an
    /// axis, by this way to either side, from where it is held again; inside its dead zone the
    /// valve lets 2 % of the command through. With what flows in the end.
    fn slips(
        holding: &mut Holding,
        [middle, dead_zone, load]: [f32; 3],
        way: f32,
    ) -> ([u32; 2], f32) {
        let (mut moved, mut flow, mut found) = (0.0_f32, 0.0, [0, 0]);
        for k in 0..60_000_u32 {
            holding.pass(0.001, true);
            let spool = holding.command().unwrap_or(0.0) - middle;
            let inside = within(spool, dead_zone);
            flow = spool - inside + 0.02 * inside + load;
            moved += 0.001 * flow;
            if moved.abs() > way {
                holding.slip(&slip(moved.signum(), way), &VALVE);
                moved = 0.0;
                found[usize::from(k >= 30_000)] += 1;
            }
        }
        (found, flow)
    }

    #[test]
    fn slips_end_whatever_the_valve_and_the_load_are() {
        for middle in [-0.02_f32, -0.01, 0.0, 0.015] {
            for dead_zone in [0.0_f32, 0.02, 0.05, 0.06] {
                for load in [-0.015_f32, -0.006, -0.001, 0.003, 0.015] {
                    let mut holding = Holding::NONE;
                    // Then another load: the bracket of before does not hold it for ever.
                    for load in [load, -load] {
                        let ([first, last], _) =
                            slips(&mut holding, [middle, dead_zone, load], FRICTION);
                        assert!(
                            first < 40 && last < 8,
                            "middle {middle}, dead zone {dead_zone}, load {load}: {first}, {last} slips"
                        );
                    }
                    assert!(holding.command().is_none_or(|c| c.abs() <= 0.1001));
                }
            }
        }
    }

    #[test]
    fn a_slip_in_motion_shows_nothing() {
        let mut holding = Holding::NONE;
        holding.pass(0.001, false);
        holding.slip(&slip(1.0, FRICTION), &VALVE);
        assert_eq!(holding, Holding::NONE);
    }

    #[test]
    fn a_slip_soon_after_the_stop_moves_no_command() {
        let mut holding = Holding::NONE;
        for direction in [1.0, -1.0, 1.0, -1.0] {
            for _ in 0..15 {
                holding.pass(0.001, true);
            }
            holding.slip(&slip(direction, FRICTION), &VALVE);
            assert_eq!(holding.command(), None);
        }
        assert!(holding.has_slipped());
    }

    #[test]
    fn an_axis_that_nothing_holds_creeps_ever_more_slowly_whatever_the_valve_and_the_load_are() {
        for middle in [-0.02_f32, 0.0, 0.015] {
            for dead_zone in [0.0_f32, 0.02, 0.05, 0.06] {
                for load in [-0.015_f32, -0.001, 0.003, 0.015] {
                    let mut holding = Holding::NONE;
                    let (_, flow) = slips(&mut holding, [middle, dead_zone, load], WINDOW);
                    assert!(
                        flow.abs() < 5e-4,
                        "middle {middle}, dead zone {dead_zone}, load {load}: {flow}"
                    );
                }
            }
        }
    }
}
