//! Validation of a model on samples that it was not made from: free simulation beside the model in
//! use.

use crate::servo::control::observer::Observer;
use crate::servo::design::ValidationDesign;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// How well a model followed the drive in free simulation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "Verdict")]
pub struct FitReport {
    /// Sum of squared errors of the candidate, in units of y squared.
    pub sse: f32,
    /// Sum of squared errors of the model in use, if there is one.
    pub incumbent_sse: Option<f32>,
    /// Sum of squares of the position about its mean.
    pub sst: f32,
    /// Samples of free simulation.
    pub samples: u32,
}

impl FitReport {
    /// R^2 = `1 - SSE/SST`: the share of the movement that the candidate explains; negative when it
    /// is worse than a constant.
    #[doc(alias = "explained")]
    pub fn r_squared(&self) -> f32 {
        if self.sst > 0.0 {
            1.0 - self.sse / self.sst
        } else {
            f32::NEG_INFINITY
        }
    }
}

/// A model in free simulation.
#[derive(Debug, Clone, PartialEq)]
struct Runner {
    observer: Observer,
    /// The flow in force until the next sample.
    flow: f32,
}

impl Runner {
    fn new(design: &ValidationDesign, model: Model, motion: Motion, flow: f32) -> Self {
        let mut observer = Observer::new(&design.observer, model);
        observer.place(motion);
        Self { observer, flow }
    }

    /// One sample; the error of the position.
    #[inline]
    fn update(&mut self, flow: f32, y: f32, observing: bool) -> f32 {
        self.observer.predict(self.flow);
        let error = if observing {
            self.observer.correct(y)
        } else {
            y - self.observer.motion().position
        };
        self.flow = flow;
        error
    }
}

/// What became of a drive by one number alone: the model in use with the velocity gain of the
/// candidate, as after a change of the valve or its supply, and with its natural frequency, all
/// that acts on the mass scaled alike, as after a change of the load.
fn simpler(candidate: &Model, incumbent: &Model) -> [Model; 2] {
    // Both were screened: their a1 is above 0.
    let stiffer = candidate.a1 / incumbent.a1;
    let gain = Model {
        b0: candidate.b0 / stiffer,
        ..*incumbent
    };
    let load = Model {
        a1: stiffer * incumbent.a1,
        a2: stiffer * incumbent.a2,
        b0: stiffer * incumbent.b0,
        friction: stiffer * incumbent.friction,
        ..*incumbent
    };
    [gain, load]
}

/// Runs candidate, model in use and its simpler changes side by side: first observed to find their
/// state, then by themselves.
///
/// A sine shows two numbers, a slow motion one: more parameters than a motion shows fit it by
/// chance, and are wrong in the next one. So of two models of the axis the simpler one is right
/// until the other is clearly better.
///
/// All get the same samples, all of them newer than the candidate. In the first phase an
/// observer finds position, velocity and acceleration; in the second
/// the models run on the commands alone and the squared errors of the position are summed.
///
/// Known as: hold-out validation, cross-validation by simulation (Ljung 1999, chapter 16).
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "Trial")]
pub(crate) struct Validation {
    candidate: Runner,
    incumbent: Option<Runner>,
    /// The simpler changes of the model in use with their sums of squared errors.
    simpler: Option<[(Runner, f32); 2]>,
    /// Samples of observation that are left, and of free simulation in all.
    observe: u32,
    window: u32,
    report: FitReport,
    origin: f32,
    sum: f32,
    squares: f32,
}

impl Validation {
    /// A validation that begins at `motion`, with `flow` in force.
    pub(crate) fn new(
        design: &ValidationDesign,
        candidate: Model,
        incumbent: Option<Model>,
        motion: Motion,
        flow: f32,
    ) -> Self {
        let run = |model: Model| Runner::new(design, model, motion, flow);
        Self {
            candidate: run(candidate),
            incumbent: incumbent.map(run),
            simpler: incumbent.map(|used| simpler(&candidate, &used).map(|m| (run(m), 0.0))),
            observe: design.observe,
            window: design.window,
            report: FitReport::default(),
            origin: motion.position,
            sum: 0.0,
            squares: 0.0,
        }
    }

    /// Takes the position y(k) and the flow in force from now on; whether that was the last sample.
    ///
    /// Cost: about 250 instructions.
    pub(crate) fn update(&mut self, flow: f32, y: f32) -> bool {
        let observing = self.observe > 0;
        let error = self.candidate.update(flow, y, observing);
        let incumbent = &mut self.incumbent;
        let beside = incumbent.as_mut().map(|run| run.update(flow, y, observing));
        for (run, sse) in self.simpler.iter_mut().flatten() {
            let error = run.update(flow, y, observing);
            *sse = if observing { 0.0 } else { *sse + error * error };
        }
        if observing {
            self.observe -= 1;
            return false;
        }
        let moved = y - self.origin;
        self.sum += moved;
        self.squares += moved * moved;
        self.report.sse += error * error;
        if let Some(error) = beside {
            let sum = self.report.incumbent_sse.unwrap_or(0.0);
            self.report.incumbent_sse = Some(sum + error * error);
        }
        self.report.samples += 1;
        if self.report.samples < self.window {
            return false;
        }
        let count = self.report.samples as f32;
        self.report.sst = self.squares - self.sum * self.sum / count;
        true
    }

    /// The report at the end: that of the best simpler change, which becomes the candidate, unless
    /// the candidate is `better` than that too.
    pub(crate) fn simplify(&mut self, better: impl Fn(&FitReport, f32) -> bool) -> FitReport {
        if let Some([gain, load]) = self.simpler.take() {
            let (run, sse) = if load.1 < gain.1 { load } else { gain };
            if !better(&self.report, sse) {
                self.candidate = run;
                self.report.sse = sse;
            }
        }
        self.report
    }

    /// The candidate.
    pub(crate) const fn candidate(&self) -> &Model {
        self.candidate.observer.model()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::config::Config;
    use crate::servo::error::Error;
    use crate::servo::motion::Travel;

    const USED: Model = Model::linear(900.0, 15.0, 9e5);

    /// What a validation of `candidate` leaves of it, on a drive under a flow that changes sign so
    /// often per second.
    fn left(candidate: Model, drive: Model, per_second: f32) -> Result<Model, Error> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let design = Config::new(1e-3, 30.0, travel).resolve()?.supervision;
        let mut motion = Motion {
            position: 200.0,
            ..Motion::default()
        };
        let mut validation =
            Validation::new(&design.validation, candidate, Some(USED), motion, 0.0);
        for k in 0.. {
            let flow = if libm::sinf(per_second * core::f32::consts::PI * 1e-3 * k as f32) < 0.0 {
                -0.3
            } else {
                0.3
            };
            let ends = validation.update(flow, motion.position);
            drive.advance(&mut motion, flow, 1e-3);
            if ends {
                break;
            }
        }
        let report = validation.simplify(|report, other| design.is_better(report, other));
        assert_eq!(design.compare(&report), Ok(true), "{report:?}");
        Ok(*validation.candidate())
    }

    #[test]
    fn what_a_change_of_one_number_explains_is_that_change() -> Result<(), Error> {
        // Gain down to 0.4; the candidate also has another frequency, which slow motion does not
        // show.
        let drive = Model {
            b0: 0.4 * USED.b0,
            ..USED
        };
        let candidate = Model::linear(1.3 * USED.a1, 1.3 * USED.a2, 0.4 * 1.3 * USED.b0);
        let found = left(candidate, drive, 1.0)?;
        assert!((found.a1 / USED.a1 - 1.0).abs() < 1e-6);
        assert!((found.b0 / drive.b0 - 1.0).abs() < 1e-5);
        // Three times the load.
        let drive = Model::linear(USED.a1 / 3.0, USED.a2 / 3.0, USED.b0 / 3.0);
        let candidate = Model {
            b0: 1.03 * drive.b0,
            ..drive
        };
        let found = left(candidate, drive, 2.0)?;
        assert!((found.b0 / found.a1 / (USED.b0 / USED.a1) - 1.0).abs() < 1e-5);
        Ok(())
    }

    #[test]
    fn what_no_change_of_one_number_explains_stays_as_it_was_found() -> Result<(), Error> {
        let drive = Model::linear(4.0 * USED.a1, 2.0 * USED.a2, 0.5 * 4.0 * USED.b0);
        assert_eq!(left(drive, drive, 2.0)?, drive);
        Ok(())
    }
}
