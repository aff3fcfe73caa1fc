//! What windows of free simulation say together: which model is clearly better than the one in use.

use crate::servo::design::SupervisionDesign;
use crate::servo::model::Model;
use crate::servo::supervision::bank;
use crate::servo::supervision::screening::{Candidate, UNKNOWN};
use crate::servo::supervision::state::Reason;
use crate::servo::supervision::validation::WindowSums;

/// Part of earlier windows that a whole new one makes forgotten: those of some seconds decide, not
/// those of an hour ago.
const FORGOTTEN: f32 = 0.2;
/// By how many windows a model of the bank is better than the model in use, and than the best
/// change of the other number, before it becomes the challenger. That alone replaces nothing: it
/// must win windows of its own, and in a loop that swings apart each window more is half a swing.
const CHALLENGES: f32 = 0.35;
const APART: f32 = 0.1;
/// What an estimate needs.
const OF_AN_ESTIMATE: Needs = Needs {
    windows: 2.0,
    better_by: 0.8,
};
/// What a model needs that comes from windows before: those count, too.
const OF_THE_BANK: Needs = Needs {
    windows: 1.0,
    better_by: 0.3,
};
/// Part of the errors of the model in use, which are never more than the movement, below which a
/// challenger is better by far: then it replaces that one after another window, even where it does
/// not explain the movement as it should.
const FAR: f32 = 0.25;
/// What one needs beyond that which neither explains the movement nor is better by far.
const POOR: Needs = Needs {
    windows: 2.0,
    better_by: 0.7,
};
/// What a lighter load needs beyond that after a heavier one, and over the model in use what is
/// lighter.
const LIGHTER: Needs = Needs {
    windows: 4.0,
    better_by: 1.2,
};
const IS_LIGHTER: f32 = 1.2;
/// Velocity gain over that of the model in use below which a model makes the controller stronger.
const WEAKER: f32 = 0.9;

/// What a challenger needs, in windows of its own: how many, and by how many better.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Needs {
    windows: f32,
    better_by: f32,
}

/// A model that would replace the one in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Challenger {
    pub(crate) model: Model,
    /// Variances of a1, a2 and b0.
    pub(crate) variances: [f32; 3],
    needs: Needs,
    /// Sums of its windows.
    own: f32,
    bank: [f32; bank::SIZE],
    moved: f32,
}

impl Challenger {
    const fn new(model: Model, variances: [f32; 3], needs: Needs) -> Self {
        Self {
            model,
            variances,
            needs,
            own: 0.0,
            bank: [0.0; bank::SIZE],
            moved: 0.0,
        }
    }
}

/// The evidence of windows about the model in use.
///
/// A window is short, and what moved in it may say little: at the turn of a sine the axis stands,
/// in a slow motion all models of the right gain are equal, and a breakaway is in none of them. So
/// windows are added up, and decide together:
///
/// ```text
/// SSE          beyond what a flow that the model in use does not know explains, and a grain at the begin
/// share        SSE / (SSE + what moved): 0 is right, 1 is astray, by however much
/// weight       rms of what moved over what hides a model: friction, dead zone, noise; at most 1, a whole window
/// bank         shares of all windows, those before times 1 - 0.2 weight; a model clearly better by 0.35 becomes the challenger
/// challenger   shares of its own windows: clearly better than the model in use by 0.8 in 2 or more (0.3 in 1 or more if it comes from the bank)
/// lighter      after a heavier load 1.2 more in 4 windows more
/// poor fit     as much again and 0.7 more in 2 windows more; not if the controller would become stronger by it
/// clearly      less than 0.7 of the share of the other, and the difference exceeds a tenth of the windows
/// ```
///
/// Friction and dead zone move the axis by the same however small the motion is, and noise and
/// digits send a simulation off by the same, so that a small motion says less of the model, in
/// proportion: it counts by its weight, and many small ones say what a large one says.
///
/// A share is at most 1, so no window says more than one window can: a shock, a motion hundred
/// times as large as those before, or a model that leaves all bounds, counts like any other. And no
/// window changes a model alone: a challenger of the bank has won one before its own, an estimate
/// wins two.
///
/// The models of a bank were there before the samples: none of them fits by chance, and no estimate
/// is needed, which in closed loop may be wrong by more than its deviations say. An estimate may;
/// but what it has from one motion does not help it in the next ones. Of two models that explain a
/// motion the simpler change is right until the other is clearly better: a sine shows two numbers,
/// a slow motion one, and more parameters than a motion shows are wrong in the next one.
///
/// A model of too little velocity gain makes the controller too strong, one of too much makes it
/// slow. Where valve, friction or limits leave all models astray, less gain explains the smaller
/// motion: a model of less gain must explain the movement, not only more of it than the model in
/// use, and a simpler change of less gain than the challenger no less than that one. And of two
/// changes of one number that explain the windows alike neither is taken.
///
/// A load that comes may go and come again. On the model of a heavier load the loop is slow with a
/// lighter one, the other way round it may be unstable: after a heavier load a lighter one must win
/// so many windows that those with the load have their say.
///
/// Known as: multiple-model estimation (Li and Bar-Shalom 1996) by errors of free simulation in the
/// place of likelihoods; a bounded loss, of the kind of Geman and McClure (Huber 2009, robust
/// statistics); parsimony principle (Ljung 1999, chapter 16).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Evidence {
    /// Whether the last other load was a heavier one.
    loaded: bool,
    sums: [f32; bank::SIZE],
    moved: f32,
    challenger: Option<Challenger>,
}

impl Evidence {
    /// Of no window.
    pub(crate) const NONE: Self = Self {
        loaded: false,
        sums: [0.0; bank::SIZE],
        moved: 0.0,
        challenger: None,
    };

    /// Begins anew, with another model in the place of the one in use.
    pub(crate) fn replaced(&mut self, used: &Model, model: &Model) {
        self.loaded = !is_lighter(model, used) && (self.loaded || is_lighter(used, model));
        self.forget();
    }

    /// Forgets all windows.
    pub(crate) fn forget(&mut self) {
        self.sums = [0.0; bank::SIZE];
        self.moved = 0.0;
        self.challenger = None;
    }

    /// The model that runs beside the bank.
    pub(crate) fn challenger(&self) -> Option<Model> {
        self.challenger.map(|challenger| challenger.model)
    }

    /// An estimate becomes the challenger, if there is none.
    pub(crate) fn propose(&mut self, candidate: &Candidate) {
        let Candidate {
            model, variances, ..
        } = *candidate;
        self.challenger
            .get_or_insert(Challenger::new(model, variances, OF_AN_ESTIMATE));
    }

    /// A model that was verified before becomes the challenger.
    pub(crate) const fn reconsider(&mut self, model: Model) {
        self.challenger = Some(Challenger::new(model, UNKNOWN, OF_THE_BANK));
    }

    /// Adds the shares of a window. Cost: about 250 instructions.
    pub(crate) fn add(&mut self, window: &WindowSums) {
        let window = window.shares();
        let kept = 1.0 - FORGOTTEN * window.weight;
        self.moved = kept * self.moved + window.moved;
        for (sum, sse) in self.sums.iter_mut().zip(window.bank) {
            *sum = kept * *sum + sse;
        }
        let (Some(challenger), Some(sse)) = (&mut self.challenger, window.challenger) else {
            return;
        };
        challenger.own += sse;
        challenger.moved += window.moved;
        for (sum, sse) in challenger.bank.iter_mut().zip(window.bank) {
            *sum += sse;
        }
    }

    /// The model that replaces the one in use; why the challenger is none.
    pub(crate) fn verdict(
        &mut self,
        design: &SupervisionDesign,
        used: &Model,
    ) -> Result<Option<Challenger>, Reason> {
        let verdict = match &self.challenger {
            Some(challenger) => challenger.verdict(design, used, self.loaded),
            None => Ok(None),
        };
        if verdict != Ok(None) {
            self.challenger = None;
        }
        if self.challenger.is_none() {
            let best = bank::best(used, &self.sums, self.moved);
            let own = self.sums[bank::USED];
            let clear = own - best.share > CHALLENGES && best.apart > APART;
            if clear && design.is_better(best.share, own, self.moved) {
                let variances = bank::variances(&best.model);
                self.challenger = Some(Challenger::new(best.model, variances, OF_THE_BANK));
            }
        }
        verdict
    }
}

impl Challenger {
    /// Itself or the simpler change in its place, once it has won; why it has lost.
    fn verdict(
        &self,
        design: &SupervisionDesign,
        used: &Model,
        loaded: bool,
    ) -> Result<Option<Self>, Reason> {
        let incumbent = self.bank[bank::USED];
        if !design.is_better(self.own, incumbent, self.moved) {
            return Err(Reason::NotBetter);
        }
        let unexplained = (1.0 - design.min_r_squared_adapting) * self.moved;
        let fits = self.own < unexplained;
        let far = self.own < FAR * incumbent;
        if !fits && is_weaker(&self.model, used) {
            return Err(Reason::PoorFit);
        }
        let Needs {
            mut windows,
            mut better_by,
        } = self.needs;
        if !fits && far {
            windows += 1.0;
        } else if !fits {
            windows += POOR.windows;
            better_by += POOR.better_by;
        }
        if loaded && is_lighter(&self.model, used) {
            windows += LIGHTER.windows;
            better_by += LIGHTER.better_by;
        }
        if self.moved < windows || incumbent - self.own < better_by {
            return Ok(None);
        }
        let simpler = bank::best(used, &self.bank, self.moved);
        let explains = simpler.share < unexplained;
        let may = explains || !fits && !is_weaker(&simpler.model, used);
        let stronger = is_weaker(&simpler.model, &self.model) && simpler.share > self.own;
        if !may || stronger || design.is_better(self.own, simpler.share, self.moved) {
            return Ok(Some(*self));
        }
        let model = simpler.model;
        Ok(Some(Self {
            model,
            variances: bank::variances(&model),
            ..*self
        }))
    }
}

/// Whether the controller would be stronger on a model than on the one in use.
fn is_weaker(model: &Model, used: &Model) -> bool {
    model.b0 * used.a1 < WEAKER * used.b0 * model.a1
}

/// Whether a model is of a lighter load than another one.
fn is_lighter(model: &Model, than: &Model) -> bool {
    model.a1 > IS_LIGHTER * than.a1
}

#[cfg(test)]
mod tests;
