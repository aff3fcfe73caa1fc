//! Everything of a run but the identifier: axis, commands, noise, and what is looked at.

use crate::random::Random;
use rand::RngExt;
use trendid::estimation::StabilisedForgetting;
use trendid::trends::FilteredTrends;
use trendid::{Identifier, Outcome};

use crate::endurance::axis::Axis;
use crate::endurance::found::Found;
use crate::endurance::motion::{Commands, Motion};
use crate::endurance::others::Others;
use crate::endurance::reading::Reading;
use crate::endurance::scenario::{Behaviour, Case, DEAD_ZONE, DT, Drive, GAIN, MOTION};
use crate::plants::valve::StaticValve;
use crate::signals::noise::{Stream, generator, quantised};

/// The estimate is looked at this often; a prime, so that no period of a command is met.
const LOOK: u64 = 997;

/// Everything of a run but the identifier.
pub(super) struct Runner<'a, A> {
    case: &'a Case,
    axis: A,
    truth: [f64; 3],
    commands: Commands,
    noise: Random,
    valve: StaticValve,
    others: Option<Others>,
    found: Found,
}

impl<'a, A: Axis> Runner<'a, A> {
    pub(super) fn new(case: &'a Case, seed: u64, axis: A, truth: [f64; 3], others: u64) -> Self {
        let dead_zone = match case.setup.drive {
            Drive::DeadZone => DEAD_ZONE,
            _ => 0.0,
        };
        Self {
            case,
            axis,
            truth,
            commands: Commands::new(
                seed,
                case.setup.bandwidth,
                GAIN,
                matches!(case.setup.drive, Drive::DeadZone | Drive::Coulomb),
                DT,
            ),
            noise: generator(seed, Stream::White),
            valve: StaticValve {
                dead_zone,
                ..StaticValve::IDEAL
            },
            others: match case.memory {
                Some(memory) if others > 0 => {
                    Some(Others::new(memory, case.setup.bandwidth, others))
                }
                _ => None,
            },
            found: Found::NOTHING,
        }
    }

    fn measured(&mut self, noisy: bool, resolution: f64) -> f64 {
        let y = self.axis.position();
        let noise = 1e-3 * self.case.setup.noise_um * (self.noise.random::<f64>() - 0.5);
        quantised(if noisy { y + noise } else { y }, resolution)
    }

    /// Runs the scenario over `samples` samples; `inputs` makes those of the identifier from
    /// command and velocity.
    pub(super) fn go<const M: usize, const N: usize, const I: usize>(
        mut self,
        samples: u64,
        mut identifier: Identifier<FilteredTrends<M>, M, N, I>,
        mut inputs: impl FnMut(f32, f64) -> [f32; I],
        read: impl Fn(&Identifier<FilteredTrends<M>, M, N, I>) -> Option<Reading>,
    ) -> Found {
        let scenario = self.case.scenario;
        let bound = self
            .case
            .memory
            .map(|memory| StabilisedForgetting::new([0.0; N], 1.0 - (DT / memory) as f32).bound());
        let prior: [f32; N] = std::array::from_fn(|j| identifier.estimator().covariance(j, j));
        self.move_about(&mut identifier, &mut inputs);
        if self.case.trusted {
            identifier.set_nominal();
            if let Some(others) = &mut self.others {
                others.set_nominal();
            }
        }
        let from = self.axis.position();
        let mut held = 0_u64;
        for k in 0..samples {
            self.behave(from, k as f64 / samples as f64, samples);
            let y = self.measured(scenario.noise, scenario.resolution);
            let u = self.commands.next(scenario.motion, k, y);
            let outcome =
                identifier.update_inputs(inputs(u as f32, self.axis.velocity()), y as f32);
            held += u64::from(matches!(outcome, Outcome::Held { .. }));
            self.step(u, y, scenario.obeys_model());
            if k % LOOK == LOOK - 1 {
                self.watch(&identifier, bound, &prior);
                if scenario.obeys_model() {
                    self.compare(read(&identifier));
                }
            }
        }
        self.found.held = held as f64 / samples.max(1) as f64;
        if !scenario.obeys_model() {
            self.axis.place(from);
            self.move_about(&mut identifier, &mut inputs);
            self.watch(&identifier, bound, &prior);
            self.compare(read(&identifier));
        }
        self.found.others_pct = self.others.as_ref().map(Others::worst);
        self.found
    }

    /// Binary noise.
    fn move_about<const M: usize, const N: usize, const I: usize>(
        &mut self,
        identifier: &mut Identifier<FilteredTrends<M>, M, N, I>,
        inputs: &mut impl FnMut(f32, f64) -> [f32; I],
    ) {
        for k in 0..MOTION {
            let y = self.measured(true, 0.0);
            let u = self.commands.next(Motion::Binary, k, y);
            let _ = identifier.update_inputs(inputs(u as f32, self.axis.velocity()), y as f32);
            self.step(u, y, true);
        }
    }

    /// Places an axis that does not obey the model, after this share of the scenario.
    fn behave(&mut self, from: f64, share: f64, samples: u64) {
        match self.case.scenario.behaviour {
            Behaviour::Stands => self.axis.place(from),
            Behaviour::Ramps => {
                let ramps = samples.div_ceil(1_000_000).max(1);
                let phase = (share * ramps as f64).fract();
                self.axis
                    .place(from + 1e7 * (1.0 - (2.0 * phase - 1.0).abs()));
            }
            Behaviour::Free => {}
        }
    }

    #[inline]
    fn step(&mut self, u: f64, y: f64, moves: bool) {
        if let Some(others) = &mut self.others {
            others.update(u, y);
        }
        if moves {
            self.axis.step(self.valve.flow(u));
        }
    }

    fn watch<const M: usize, const N: usize, const I: usize>(
        &mut self,
        identifier: &Identifier<FilteredTrends<M>, M, N, I>,
        bound: Option<f32>,
        prior: &[f32; N],
    ) {
        let estimator = identifier.estimator();
        self.found.finite &= estimator
            .diagonal()
            .iter()
            .all(|d| *d > 0.0 && d.is_finite())
            && estimator.theta().iter().all(|t| t.is_finite())
            && identifier.theta().iter().all(|t| t.is_finite());
        for (j, prior) in prior.iter().enumerate() {
            // The initial state is as uncertain as at the start whenever the trends begin anew.
            let begins = j + 1 == N && identifier.structure().initial_state();
            let limit = match bound {
                Some(bound) if begins => bound.max(*prior),
                Some(bound) => bound,
                None => *prior,
            };
            let share = f64::from(estimator.covariance(j, j) / limit);
            self.found.over_bound = self.found.over_bound.max(share);
        }
    }

    fn compare(&mut self, reading: Option<Reading>) {
        let digit = f64::from(f32::EPSILON) * self.axis.position().abs();
        let resolved = digit <= 1e-3 * self.case.setup.noise_um;
        self.found.compare(reading, &self.truth, resolved);
        if let Some(others) = &mut self.others {
            others.look(&self.truth);
        }
    }
}
