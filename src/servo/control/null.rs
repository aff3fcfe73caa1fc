//! The offset of the valve, learned from sliding both ways.

use crate::math::within;

/// Flows up to which the disturbance shows the offset of the valve, time over 1/wd for which both
/// ways must have been seen, rate of the correction over wd, and the most that a commissioning may
/// be wrong by.
const FLOW: f32 = 0.5;
const KNOWN: f32 = 3.0;
const SHARE: f32 = 0.3;
const MOST: f32 = 0.08;

/// Offset of the valve beyond that of the model.
///
/// Behind a dead zone that is wrong by e and an offset that is wrong by o the disturbance is
/// `o - e` upwards and `o + e` downwards: half of their sum is o, whatever e is. It goes from the
/// disturbance to the valve without a step.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct NullOffset {
    value: f32,
    /// Mean disturbance of each way, as a flow, and the time over 1/wd for which it was seen.
    means: [f32; 2],
    known: [f32; 2],
}

impl NullOffset {
    /// Takes the flow and the disturbance of a sample in motion; `share`: sample time times wd.
    /// Gives the flow that goes from the disturbance to the valve. Cost: about 20 instructions.
    #[inline]
    pub(crate) fn update(&mut self, flow: f32, disturbance: f32, share: f32) -> Option<f32> {
        if within(flow, FLOW) != flow {
            return None;
        }
        let side = usize::from(flow > 0.0);
        self.means[side] += share * (disturbance - self.means[side]);
        self.known[side] += share;
        if self.known[0] < KNOWN || self.known[1] < KNOWN {
            return None;
        }
        let step = SHARE * share * 0.5 * (self.means[0] + self.means[1]);
        let next = within(self.value + step, MOST);
        let step = next - self.value;
        self.value = next;
        self.means = self.means.map(|mean| mean - step);
        Some(step)
    }

    /// The offset beyond that of the model.
    pub(crate) const fn value(&self) -> f32 {
        self.value
    }
}
