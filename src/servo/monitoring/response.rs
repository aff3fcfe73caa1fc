//! The motion of the axis: as its valve lets expect it, and as the sensor shows it.

use crate::servo::monitoring::bounds::Bounds;

/// Both sides of the equation of the drive, as velocities, and what they show of each other.
///
/// ```text
/// v'' + a2 v' + a1 v = b0 q - (friction sgn v)' ..,   through w^2 / (s + w)^2, over a1 = w^2:
/// commanded = C q_2        shown = v - 2 (1 - xi) (v_1 - v_2)        _1, _2: through w / (s + w) once, twice
/// ```
///
/// A drive of the model shows what is commanded, whatever it did more than some 1/w ago: no motion
/// is simulated, so that no phase of a swing and no side on which friction holds the axis can be
/// wrong. A flow as wrong as `q` leaves `C q`, friction some `friction / w`. Three faults are three
/// hypotheses about the velocity that is shown:
///
/// | fault | shown | share of its energy that this explains |
/// |---|---|---|
/// | wrong sign of valve or sensor | `-g commanded`, g > 0 | `(sum shown commanded)^2 / (sum shown^2 sum commanded^2)` |
/// | a spool that is stuck | any constant | `(sum shown)^2 / (n sum shown^2)` |
/// | a closed valve, a clamped slide | nothing | |
///
/// Both of the first have one free number, so that the one with the larger share is the more likely
/// one, whatever the noise: with Gaussian errors of one variance it has the larger likelihood. The
/// shares are between 0 and 1 (Cauchy and Schwarz). A gain g below 1 is a weak drive: air that goes
/// back into a supply that is lost moves the axis against its command as well.
///
/// The sums forget within 1/(2 w), and not while the valve is closed to find out.
/// Cost: about 45 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Response {
    commanded: [f32; 2],
    filtered: [f32; 2],
    /// Sums: weight, velocity shown, its product with the commanded one, squares of both.
    weight: f32,
    shown: f32,
    product: f32,
    squares: [f32; 2],
}

/// Share of the commanded energy below which nothing is shown: a fifth of the velocity.
const FAINT: f32 = 0.04;

impl Response {
    /// One sample with the flow that takes effect now and the measured velocity; with a `weight`
    /// below 1 nothing is forgotten.
    #[inline]
    pub(crate) fn update(&mut self, flow: f32, velocity: f32, weight: f32, bounds: &Bounds) {
        let share = bounds.response.share;
        for (state, input) in [
            (&mut self.commanded, bounds.gain * flow),
            (&mut self.filtered, velocity),
        ] {
            state[0] += share * (input - state[0]);
            state[1] += share * (state[0] - state[1]);
        }
        let commanded = self.commanded[1];
        let shown = velocity - bounds.response.lack * (self.filtered[0] - self.filtered[1]);
        let share = weight * bounds.response.evidence;
        let kept = if weight < 1.0 { 1.0 } else { 1.0 - share };
        let [commanded2, shown2] = self.squares;
        self.weight = kept * self.weight + share;
        self.shown = kept * self.shown + share * shown;
        self.product = kept * self.product + share * commanded * shown;
        self.squares = [
            kept * commanded2 + share * commanded * commanded,
            kept * shown2 + share * shown * shown,
        ];
    }

    /// The velocity that the valve lets expect.
    pub(crate) const fn commanded(&self) -> f32 {
        self.commanded[1]
    }

    /// Whether the axis shows too little motion for either fault.
    pub(crate) fn is_faint(&self) -> bool {
        let [commanded, shown] = self.squares;
        !(shown > FAINT * commanded)
    }

    /// How much more of the motion a wrong sign explains than a spool that is stuck: -1 to 1. Not
    /// for every sample: it divides.
    pub(crate) fn mirrored(&self) -> f32 {
        let [commanded, shown] = self.squares;
        let energy = commanded * shown * self.weight;
        if !(energy > 0.0) {
            return 0.0;
        }
        let sign = if self.product < 0.0 {
            self.product
        } else {
            0.0
        };
        let stuck = self.shown * self.shown * commanded;
        (sign * sign * self.weight - stuck) / energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;
    use crate::servo::motion::Motion;

    /// The response of a drive to a flow that grows as that of a loop that runs away: the drive
    /// takes it times `sign`, or stands open by `stuck`.
    fn response(seed: u32, sign: f32, stuck: f32) -> Response {
        let mut state = seed;
        let mut uniform = move |low: f32, high: f32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            low + (high - low) * ((state >> 8) as f32 / 16_777_216.0)
        };
        let w = uniform(8.0, 80.0);
        let model = Model::linear(w * w, uniform(0.1, 2.0) * w, w * w * uniform(300.0, 3000.0));
        let bounds = example::bounds(&model);
        let real = Model {
            b0: uniform(0.7, 1.3) * model.b0,
            ..model
        };
        let (mut motion, mut response) = (Motion::default(), Response::default());
        for _ in 0..(20_000.0 / w) as u32 {
            real.advance(&mut motion, stuck, 0.001);
            response.update(stuck, motion.velocity, 1.0, &bounds);
        }
        let (mut flow, rate) = (uniform(0.01, 0.05), uniform(0.5, 2.0) * w * 0.001);
        while flow < 0.9 {
            flow += rate * flow;
            real.advance(&mut motion, sign * flow + stuck, 0.001);
            response.update(flow, motion.velocity, 1.0, &bounds);
        }
        response
    }

    #[test]
    fn the_hypothesis_that_holds_explains_more() {
        for seed in 0..300 {
            let wrong_sign = response(seed, -1.0, 0.0);
            assert!(wrong_sign.mirrored() > 0.0, "seed {seed}: wrong sign");
            assert!(!wrong_sign.is_faint(), "seed {seed}");
            assert!(
                response(seed, 0.0, -0.4).mirrored() < 0.0,
                "seed {seed}: stuck"
            );
            assert!(
                response(seed, 1.0, 0.0).mirrored() <= 0.0,
                "seed {seed}: sound"
            );
            assert!(response(seed, 0.0, 0.0).is_faint(), "seed {seed}: closed");
        }
        assert_eq!(Response::default().mirrored(), 0.0, "nothing known");
    }

    #[test]
    fn an_axis_that_nothing_moves_and_one_that_hardly_moves_are_faint() {
        assert!(Response::default().is_faint());
        // A fifth of the velocity that is commanded.
        for (shown, faint) in [(0.19, true), (0.21, false), (-0.19, true), (-0.21, false)] {
            let response = Response {
                squares: [900.0, 900.0 * shown * shown],
                ..Response::default()
            };
            assert_eq!(response.is_faint(), faint, "{shown}");
        }
    }

    #[test]
    fn a_share_that_is_explained_is_the_same_of_little_that_is_known() {
        let (commanded, shown) = (300.0, 100.0);
        for weight in [0.1_f32, 0.5, 1.0] {
            // Both ways for as long: what is shown is the opposite, or a constant.
            let squares = [weight * commanded * commanded, weight * shown * shown];
            let opposite = Response {
                weight,
                squares,
                product: -weight * commanded * shown,
                ..Response::default()
            };
            let constant = Response {
                weight,
                squares,
                shown: weight * shown,
                ..Response::default()
            };
            for (response, exact) in [(opposite, 1.0), (constant, -1.0)] {
                let found = response.mirrored();
                assert!(
                    (found - exact).abs() < 1e-5,
                    "{weight}: {found}, not {exact}"
                );
            }
        }
    }
}
