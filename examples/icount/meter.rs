//! What takes the rows of the counts: a counter of instructions on the target, a stopwatch on the
//! host.

use core::hint::black_box;

#[cfg(target_os = "none")]
use trendid_example_support::board::line;
#[cfg(target_os = "none")]
use trendid_example_support::clock::Clock;
#[cfg(target_os = "none")]
use trendid_example_support::stack;

/// Something that takes the rows one after the other.
pub(crate) trait Meter {
    /// Runs `step` over `samples`, twice the whole record.
    fn row<S: Clone, U: Copy, R>(
        &mut self,
        name: &str,
        function: &str,
        n: usize,
        state: S,
        samples: impl Iterator<Item = (U, f32)>,
        step: impl Fn(&mut S, &U, f32) -> R,
    );
}

/// Counts the instructions of each step with two clocks.
#[cfg(target_os = "none")]
pub(crate) struct Counter {
    clocks: [Clock; 2],
    /// Ticks of a function of one instruction, its return.
    idle: [f32; 2],
    /// Whether the two clocks disagreed.
    pub systick_off: bool,
}

#[cfg(target_os = "none")]
impl Counter {
    /// A counter that has not yet counted the row of nothing.
    pub(crate) fn new(clocks: [Clock; 2]) -> Self {
        Self {
            clocks,
            idle: [0.0; 2],
            systick_off: false,
        }
    }

    /// Writes the line of a row, or takes the row of nothing. Once for all rows: the smallest
    /// machine has no room for more.
    #[inline(never)]
    fn finish(&mut self, [name, function]: [&str; 2], [n, ram]: [usize; 2], counted: &Counted) {
        let [fine, systick] = self.clocks;
        let mean = counted
            .sums
            .map(|sum| (sum / f64::from(counted.count)) as f32);
        if n == 0 {
            self.idle = mean;
            return;
        }
        let units = |clock: &Clock, i: usize, ticks: f32| clock.units(ticks - self.idle[i]) + 1.0;
        let by_fine = units(&fine, 0, mean[0]);
        let by_systick = units(&systick, 1, mean[1]);
        // Two counters with their own calibration must agree. SysTick counts in steps of
        // six instructions, and in a repeatable run the part of a step does not average out.
        const STEP: f32 = 6.0;
        if (by_systick - by_fine).abs() > 0.02 * by_fine + STEP {
            self.systick_off = true;
        }
        // By integers: what writes a float takes 20 kB.
        let [mean, coarse] = [by_fine, by_systick].map(|units| (10.0 * units + 0.5) as u32);
        let worst = (units(&fine, 0, counted.worst as f32) + 0.5) as u32;
        line(format_args!(
            "{name};{function};{n};{}.{};{worst};{}.{};{};{ram}",
            mean / 10,
            mean % 10,
            coarse / 10,
            coarse % 10,
            counted.peak,
        ));
    }
}

/// What was counted of a row: ticks of both clocks and the most by the finer one, bytes of stack,
/// steps.
#[cfg(target_os = "none")]
struct Counted {
    sums: [f64; 2],
    worst: u32,
    peak: usize,
    count: u32,
}

#[cfg(target_os = "none")]
impl Meter for Counter {
    #[inline(never)]
    fn row<S: Clone, U: Copy, R>(
        &mut self,
        name: &str,
        function: &str,
        n: usize,
        mut subject: S,
        samples: impl Iterator<Item = (U, f32)>,
        step: impl Fn(&mut S, &U, f32) -> R,
    ) {
        let [fine, systick] = self.clocks;
        let mut sums = [0.0f64; 2];
        let (mut worst, mut longest, mut peak, mut count) = (0, 0, 0, 0);
        let mut copy = subject.clone();
        for (k, (u, y)) in samples.enumerate() {
            let (u, y) = black_box((u, y));
            // Both clocks count the same step, so one of them works on a copy.
            copy.clone_from(&subject);
            let coarse = systick.ticks(|| step(black_box(&mut copy), &u, y));
            sums[1] += f64::from(coarse);
            // Painting takes longer than a step: now and then, and where the step takes longer than
            // any before.
            if k % 100 == 1 || coarse > longest {
                longest = longest.max(coarse);
                copy.clone_from(&subject);
                peak = peak.max(stack::peak(|| step(black_box(&mut copy), &u, y)));
            }
            let ticks = fine.ticks(|| step(black_box(&mut subject), &u, y));
            sums[0] += f64::from(ticks);
            worst = worst.max(ticks);
            count += 1;
        }
        let counted = Counted {
            sums,
            worst,
            peak,
            count,
        };
        self.finish([name, function], [n, size_of::<S>()], &counted);
    }
}

/// Takes the wall time of a row.
#[cfg(not(target_os = "none"))]
pub(crate) struct Stopwatch;

#[cfg(not(target_os = "none"))]
impl Meter for Stopwatch {
    fn row<S: Clone, U: Copy, R>(
        &mut self,
        name: &str,
        _function: &str,
        n: usize,
        mut state: S,
        samples: impl Iterator<Item = (U, f32)>,
        step: impl Fn(&mut S, &U, f32) -> R,
    ) {
        let samples: Vec<_> = samples.collect();
        let start = std::time::Instant::now();
        for (u, y) in &samples {
            let _ = black_box(step(black_box(&mut state), u, *y));
        }
        let nanoseconds = start.elapsed().as_nanos() as f64 / samples.len() as f64;
        println!(
            "{name:16} n = {n}  {nanoseconds:7.1} ns per update, {} bytes",
            size_of::<S>()
        );
    }
}
