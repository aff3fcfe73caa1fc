//! A window of free simulation: how far models follow later samples on the commands alone.

use crate::servo::control::observer::Observer;
use crate::servo::design::ValidationDesign;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::supervision::bank;

/// How well a model followed the drive in free simulation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "Verdict")]
pub struct FitReport {
    /// Sum of squared errors of the candidate, in units of y squared; of the model in use where
    /// there is no candidate.
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
    sse: f32,
}

impl Runner {
    fn new(design: &ValidationDesign, model: Model, motion: Motion) -> Self {
        let mut observer = Observer::new(&design.observer, model);
        observer.place(motion);
        Self { observer, sse: 0.0 }
    }

    /// One sample under the flow that was in force, with the position at its end.
    #[inline]
    fn update(&mut self, flow: f32, y: f32, observing: bool) {
        self.observer.predict(flow);
        if observing {
            self.observer.correct(y);
        } else {
            let error = y - self.observer.motion().position;
            self.sse += error * error;
        }
    }
}

/// Runs the bank about the model in use and a challenger side by side: first observed to find their
/// state, then by themselves.
///
/// All get the same samples, newer than any of them. In the first phase an observer finds position,
/// velocity and acceleration; in the second the models run on the commands alone and the squared
/// errors of the position are summed.
///
/// Known as: hold-out validation, cross-validation by simulation (Ljung 1999, chapter 16), of a
/// bank of models (multiple-model estimation, Li and Bar-Shalom 1996).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Window {
    bank: [Runner; bank::SIZE],
    challenger: Option<Runner>,
    /// The flow in force until the next sample.
    flow: f32,
    /// Samples of observation that are left, and of free simulation in all and so far.
    observe: u32,
    window: u32,
    samples: u32,
    origin: f32,
    sum: f32,
    squares: f32,
}

/// Sums of squares of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sums {
    /// Errors of the bank and of the challenger.
    pub(crate) bank: [f32; bank::SIZE],
    pub(crate) challenger: Option<f32>,
    /// The position about its mean.
    pub(crate) moved: f32,
}

impl Sums {
    pub(crate) fn shares(&self) -> Self {
        let share = |sse: f32| {
            if sse < f32::INFINITY {
                sse / (sse + self.moved)
            } else {
                1.0
            }
        };
        Self {
            bank: self.bank.map(share),
            challenger: self.challenger.map(share),
            moved: 1.0,
        }
    }
}

impl Window {
    /// A window that begins at `motion`, with `flow` in force.
    pub(crate) fn new(
        design: &ValidationDesign,
        used: &Model,
        challenger: Option<Model>,
        motion: Motion,
        flow: f32,
    ) -> Self {
        let run = |model| Runner::new(design, model, motion);
        Self {
            bank: bank::about(used).map(run),
            challenger: challenger.map(run),
            flow,
            observe: design.observe,
            window: design.window,
            samples: 0,
            origin: motion.position,
            sum: 0.0,
            squares: 0.0,
        }
    }

    /// Takes the position y(k) and the flow in force from now on; whether that was the last sample.
    ///
    /// Cost: about 60 instructions per model.
    pub(crate) fn update(&mut self, flow: f32, y: f32) -> bool {
        let observing = self.observe > 0;
        for run in self.bank.iter_mut().chain(&mut self.challenger) {
            run.update(self.flow, y, observing);
        }
        self.flow = flow;
        if observing {
            self.observe -= 1;
            return false;
        }
        let moved = y - self.origin;
        self.sum += moved;
        self.squares += moved * moved;
        self.samples += 1;
        self.samples >= self.window
    }

    /// What it showed; `None` when the axis moved by less than `least` about its mean.
    pub(crate) fn sums(&self, least: f32) -> Option<Sums> {
        let count = self.samples as f32;
        let moved = self.squares - self.sum * self.sum / count;
        (moved > least * least * count).then(|| Sums {
            bank: self.bank.each_ref().map(|run| run.sse),
            challenger: self.challenger.as_ref().map(|run| run.sse),
            moved,
        })
    }

    /// How well the challenger has followed, or the model in use where there is none.
    pub(crate) fn report(&self, sums: &Sums) -> FitReport {
        let used = sums.bank[bank::USED];
        FitReport {
            sse: sums.challenger.unwrap_or(used),
            incumbent_sse: Some(used),
            sst: sums.moved,
            samples: self.samples,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::config::Config;
    use crate::servo::error::Error;
    use crate::servo::motion::Travel;

    const USED: Model = Model::linear(900.0, 15.0, 9e5);

    /// A window on a drive under a flow that changes its sign so often per second.
    fn seen(drive: &Model, challenger: Option<Model>, per_second: f32) -> Result<Window, Error> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let design = Config::new(1e-3, 30.0, travel).resolve()?.supervision;
        let mut motion = Motion {
            position: 200.0,
            ..Motion::default()
        };
        let mut window = Window::new(&design.validation, &USED, challenger, motion, 0.0);
        let (mut ends, mut samples) = (false, 0);
        while !ends {
            let turned = libm::sinf(per_second * core::f32::consts::PI * 1e-3 * samples as f32);
            let flow = if turned < 0.0 { -0.3 } else { 0.3 };
            ends = window.update(flow, motion.position);
            drive.advance(&mut motion, flow, 1e-3);
            samples += 1;
        }
        assert_eq!(
            samples,
            design.validation.observe + design.validation.window
        );
        Ok(window)
    }

    #[test]
    fn the_model_of_the_drive_leaves_least_whatever_it_is() -> Result<(), Error> {
        for (k, drive) in bank::about(&USED).into_iter().enumerate() {
            let window = seen(&drive, None, 4.0)?;
            let sums = window.sums(0.0).unwrap_or(Sums {
                bank: [f32::NAN; bank::SIZE],
                challenger: None,
                moved: 0.0,
            });
            for (j, sum) in sums.bank.iter().enumerate() {
                let right = *sum < 1e-3 * sums.moved;
                assert_eq!(right, j == k, "{k}: {sums:?}");
            }
        }
        Ok(())
    }

    #[test]
    fn a_challenger_runs_beside_them_and_is_reported() -> Result<(), Error> {
        let drive = Model::linear(400.0, 30.0, 6e5);
        let window = seen(&drive, Some(drive), 3.0)?;
        let Some(sums) = window.sums(1.0) else {
            panic!("the axis moved");
        };
        assert!(sums.challenger.is_some_and(|sse| sse < 1e-3 * sums.moved));
        let report = window.report(&sums);
        assert!(report.r_squared() > 0.999, "{report:?}");
        assert_eq!(report.incumbent_sse, Some(sums.bank[bank::USED]));
        assert_eq!((report.sst, report.samples), (sums.moved, window.window));
        // Without one the report is that of the model in use.
        let window = seen(&drive, None, 3.0)?;
        let report = window.report(&Sums {
            challenger: None,
            ..sums
        });
        assert_eq!(Some(report.sse), report.incumbent_sse);
        Ok(())
    }

    #[test]
    fn a_window_without_motion_shows_nothing() -> Result<(), Error> {
        let window = seen(&USED, None, 4.0)?;
        let moved = window.sums(0.0).map_or(0.0, |sums| sums.moved);
        let rms = crate::math::sqrt(moved / window.samples as f32);
        assert!(window.sums(0.99 * rms).is_some() && window.sums(1.01 * rms).is_none());
        Ok(())
    }

    #[test]
    fn a_share_is_one_at_most_whatever_the_errors() {
        let sums = Sums {
            bank: core::array::from_fn(|k| [0.0, 1.0, 3.0, 1e38, f32::INFINITY][k.min(4)]),
            challenger: Some(f32::NAN),
            moved: 1.0,
        };
        let shares = sums.shares();
        assert_eq!(shares.bank[..3], [0.0, 0.5, 0.75]);
        assert!(shares.bank[3..].iter().all(|share| *share == 1.0));
        assert_eq!((shares.challenger, shares.moved), (Some(1.0), 1.0));
    }

    #[test]
    fn a_share_that_is_explained_is_one_of_the_movement() {
        let report = |sse, sst| FitReport {
            sse,
            sst,
            ..FitReport::default()
        };
        assert_eq!(report(1.0, 4.0).r_squared(), 0.75);
        assert_eq!(report(8.0, 4.0).r_squared(), -1.0);
        assert_eq!(report(1.0, 0.0).r_squared(), f32::NEG_INFINITY);
    }
}
