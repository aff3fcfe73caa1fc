//! The motion that is wanted, and the one that is measured.

use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;

/// Reference and measured motion of the axis.
#[derive(Debug, Clone)]
pub(crate) struct Moves {
    pub(crate) trajectory: Trajectory,
    /// Pole in rad/s with which a motion that is taken over runs out.
    pub(crate) run_out_rate: f32,
    /// The motion from the positions alone.
    pub(crate) tracking: AlphaBetaGamma,
}
