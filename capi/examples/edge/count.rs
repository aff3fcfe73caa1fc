//! Counts of calls on the record.

use core::hint::black_box;

use trendid_example_support::board::line;
use trendid_example_support::clock::Clock;
use trendid_example_support::record;

/// A function of one instruction, its return.
#[inline(never)]
pub(crate) fn nothing(u: f32) -> f32 {
    u
}

/// Counts of one call.
#[derive(Default)]
pub(crate) struct Count {
    sum: u64,
    worst: u32,
    calls: u32,
}

impl Count {
    /// Out of line: inlined, its arithmetic would be moved between the readings of the clock.
    #[inline(never)]
    pub(crate) fn take(&mut self, ticks: u32) {
        self.sum += u64::from(ticks);
        self.worst = self.worst.max(ticks);
        self.calls += 1;
    }

    pub(crate) fn mean(&self) -> f32 {
        (self.sum as f64 / f64::from(self.calls)) as f32
    }
}

/// One row: both calls on every sample.
pub(crate) fn row(
    clock: &Clock,
    idle: f32,
    name: &str,
    mut step: impl FnMut(usize, f32, f32) -> [u32; 2],
) {
    let mut counts = [Count::default(), Count::default()];
    for (k, (u, y)) in record::samples().enumerate() {
        let both = step(k, black_box(u), black_box(y));
        for (count, ticks) in counts.iter_mut().zip(both) {
            count.take(ticks);
        }
    }
    let mean = |count: &Count| clock.units(count.mean() - idle) + 1.0;
    let worst = |count: &Count| clock.units(count.worst as f32 - idle) + 1.0;
    let [rust, edge] = counts;
    line(format_args!(
        "{name};{:.1};{:.0};{:.1};{:.0}",
        mean(&rust),
        worst(&rust),
        mean(&edge),
        worst(&edge)
    ));
}
