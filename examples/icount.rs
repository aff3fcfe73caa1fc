//! Instructions per `update` on an emulated Cortex-M, cycles on a board; wall time per update on the host.
//!
//! `cargo xtask icount` runs it in the emulator and prints the table with code size, memory and stack. The image writes
//! one line `row;function;n;mean;worst;systick;stack;ram` per row, behind comment lines that begin with `#`.
//!
//! What is counted is the function of the row from its first instruction to its return, as a user calls it.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod firmware;

#[path = "firmware/drive.rs"]
mod drive;

use core::hint::black_box;

use drive::{Drive, SimulatedValve};
use firmware::{record, rows};
use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::{
    Estimator, FilteredTrends, LoopConfig, Outcome, Report, Scheme, ServoError, ServoLoop, Travel,
};

/// How often the record is run: 10 000 samples.
const ROUNDS: usize = 2;

/// One function per row: found in the image by its name.
macro_rules! functions {
    ($($name:ident($type:ty, $input:ty) -> $result:ty, |$state:ident, $u:ident, $y:ident| $body:expr;)*) => {$(
        #[inline(never)]
        // SAFETY: the name is used once in this image.
        #[unsafe(no_mangle)]
        fn $name($state: &mut $type, $u: $input, $y: f32) -> $result {
            $body
        }
    )*};
}

functions! {
    row_nothing((), f32) -> f32, |_state, u, _y| u;
    row_raw(rows::Raw, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_filtered(rows::Filtered, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_integral(rows::Integral, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_servo(Servo<Still>, (i32, Option<f32>)) -> Report, |state, u, _y| {
        state.sensor_mut().code = u.0;
        if let Some(target) = u.1 {
            state.move_to(target);
        }
        state.update()
    };
    row_constant(rows::Offset, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_dead_zone(rows::DeadZone, f32) -> Outcome, |state, u, y| {
        state.update_inputs(rows::dead_zone_inputs(u), y)
    };
    row_full(rows::Full, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_exact(rows::Exact, f32) -> Outcome, |state, u, y| state.update(u, y);
    row_bank(rows::Bank, f32) -> Outcome, |state, u, y| state.update_inputs([u], y);
    row_estimate(rows::Offset, f32) -> [f32; 4], |state, _u, _y| state.theta();
    row_std(rows::Offset, f32) -> [f32; 4], |state, _u, _y| state.std();
    row_exact_estimate(rows::Exact, f32) -> [f32; 4], |state, _u, _y| state.theta();
    row_retune((rows::Offset, FilteredTrends<3>), f32) -> bool, |state, _u, _y| {
        let (identifier, trends) = state;
        identifier.retune(*trends, 0.1).is_ok()
    };
    row_bare_3(Estimator<3>, &[f32; 3]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bare_4(Estimator<4>, &[f32; 4]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bare_5(Estimator<5>, &[f32; 5]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_bare_6(Estimator<6>, &[f32; 6]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_pulled_3(Pulled<3>, &[f32; 3]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_pulled_4(Pulled<4>, &[f32; 4]) -> f32, |state, phi, psi| state.update(phi, psi);
    row_pulled_5(Pulled<5>, &[f32; 5]) -> f32, |state, phi, psi| state.update(phi, psi);
}

/// The whole position loop, from the code of the encoder to the command of the valve.
type Servo<V> = ServoLoop<Code, V>;

/// An encoder that gives the code it was told.
#[derive(Debug, Clone, Copy)]
struct Code {
    code: i32,
}

impl PositionSensor for Code {
    type Error = core::convert::Infallible;

    fn counts(&mut self) -> Result<i32, Self::Error> {
        Ok(self.code)
    }
}

/// A valve that moves nothing.
#[derive(Debug, Clone, Copy)]
struct Still;

impl Valve for Still {
    type Error = core::convert::Infallible;

    fn drive(&mut self, command: f32) -> Result<f32, Self::Error> {
        Ok(command)
    }
}

/// Code of the encoder at the begin of the travel.
const ORIGIN: i32 = 8_000_000;

/// A loop on the simulated drive of 20 rad/s and 400 mm, about to commission itself.
fn servo<V: Valve>(valve: V) -> Result<Servo<V>, ServoError> {
    let axis = Axis {
        scale: const { Scale::new(0.005).unwrap() },
        reference: ORIGIN,
    };
    let travel = Travel {
        begin: 0.0,
        end: 400.0,
    };
    let config = LoopConfig::new(20.0, travel);
    let mut servo = ServoLoop::try_new(&config, axis, Code { code: ORIGIN }, valve)?;
    servo.commission();
    Ok(servo)
}

/// Codes of the drive under a loop of its own, and a move every second.
fn motion(mut leader: Servo<SimulatedValve>) -> impl Iterator<Item = ((i32, Option<f32>), f32)> {
    let mut drive = Drive::new();
    (0..ROUNDS * record::SAMPLES).map(move |k| {
        let code = drive.counts().unwrap_or(ORIGIN);
        let target = (k % 1000 == 999).then_some(if k % 2000 == 999 { 250.0 } else { 150.0 });
        leader.sensor_mut().code = code;
        if let Some(target) = target {
            leader.move_to(target);
        }
        let _ = leader.update();
        ((code, target), 0.0)
    })
}

/// The bare estimator with its covariance bounded at rest, one parameter per sample in turn.
#[derive(Clone, Copy)]
struct Pulled<const N: usize> {
    estimator: Estimator<N>,
    turn: usize,
}

impl<const N: usize> Pulled<N> {
    #[inline(always)]
    fn update(&mut self, phi: &[f32; N], psi: f32) -> f32 {
        let innovation = self.estimator.update(phi, psi);
        self.turn = if self.turn + 1 < N { self.turn + 1 } else { 0 };
        self.estimator.relax(self.turn, 0.0, 1e4, 1e-7);
        innovation
    }
}

/// Something that takes the rows one after the other: a counter on the target, a stopwatch on the host.
trait Meter {
    /// Runs `step` over `samples`, twice the whole record.
    fn row<S: Copy, U: Copy, R>(
        &mut self,
        name: &str,
        function: &str,
        n: usize,
        state: S,
        samples: impl Iterator<Item = (U, f32)>,
        step: impl Fn(&mut S, &U, f32) -> R,
    );
}

/// The record as often as it is run. Each round goes on where the round before ended.
fn samples() -> impl Iterator<Item = (f32, f32)> {
    let end = record::samples().last().map_or(0.0, |(_, y)| y);
    (0..ROUNDS)
        .flat_map(move |round| record::samples().map(move |(u, y)| (u, y + end * round as f32)))
}

/// Regressors of independent numbers in -1..1 and what the parameters 1, 2, .. make of them, with noise.
fn rows_of_numbers<const N: usize>() -> impl Iterator<Item = ([f32; N], f32)> {
    let mut seed = 1u32;
    (0..ROUNDS * record::SAMPLES).map(move |_| {
        let mut number = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 * (2.0 / 16_777_216.0) - 1.0
        };
        let phi: [f32; N] = core::array::from_fn(|_| number());
        let mut psi = 0.01 * number();
        for (j, x) in phi.iter().enumerate() {
            psi += (j + 1) as f32 * x;
        }
        (phi, psi)
    })
}

/// The rows of a table: name, n, function, state, samples. `*` for a function that takes its input by value.
macro_rules! rows {
    ($meter:ident; $($name:literal, $n:literal, $by:tt $function:ident, $state:expr, $samples:expr;)*) => {$(
        $meter.row($name, stringify!($function), $n, $state, $samples, rows!($by $function));
    )*};
    (* $function:ident) => { |s, &u, y| $function(s, u, y) };
    (& $function:ident) => { $function };
}

fn all(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    rows! { meter;
        "nothing", 0, *row_nothing, (), samples();
        "raw Goodwin", 3, *row_raw, rows::raw(Scheme::Goodwin)?, samples();
        "raw Tustin", 3, *row_raw, rows::raw(Scheme::Tustin)?, samples();
        "filtered Tustin", 3, *row_filtered, rows::filtered(Scheme::Tustin)?, samples();
        "default (with start)", 4, *row_constant, rows::default()?, samples();
        "default with memory", 4, *row_constant, rows::following()?, samples();
    }
    // A Cortex-M0 (no atomic exchange) has no room for several copies of its window.
    if cfg!(target_has_atomic = "32") {
        rows! { meter;
            "over a span of 70", 3, *row_integral, rows::integral()?, samples();
        }
    }
    if let (Ok(leader), Ok(follower)) = (servo(SimulatedValve), servo(Still)) {
        rows! { meter;
            "whole position loop", 6, *row_servo, follower, motion(leader);
        }
    }
    rows! { meter;
        "with constant", 4, *row_constant, rows::offset()?, samples();
        "with dead zone", 5, *row_dead_zone, rows::dead_zoned()?, samples();
        "default, exact hold", 4, *row_exact, rows::exact()?, samples();
    }
    // As for the span: eight identifiers are too many for the smallest memory.
    if cfg!(target_has_atomic = "32") {
        rows! { meter;
            "delay bank of 8", 4, *row_bank, rows::bank()?, samples();
        }
    }
    now_and_then(meter)?;
    rows! { meter;
        "order 3 full", 6, *row_full, rows::full()?, samples();
        "bare estimator", 3, &row_bare_3, bare(), rows_of_numbers();
        "bare estimator", 4, &row_bare_4, bare(), rows_of_numbers();
        "bare estimator", 5, &row_bare_5, bare(), rows_of_numbers();
        "bare estimator", 6, &row_bare_6, bare(), rows_of_numbers();
        "bare, bounded at rest", 3, &row_pulled_3, pulled(), rows_of_numbers();
        "bare, bounded at rest", 4, &row_pulled_4, pulled(), rows_of_numbers();
        "bare, bounded at rest", 5, &row_pulled_5, pulled(), rows_of_numbers();
    }
    Ok(())
}

/// What is asked for now and then, not in every sample: each call counted, after the record has been seen once.
fn now_and_then(meter: &mut impl Meter) -> Result<(), trendid::ConfigError> {
    let calls = || record::samples().take(CALLS);
    let (mut default, mut exact) = (rows::default()?, rows::exact()?);
    for (u, y) in record::samples() {
        // The counted functions themselves: a second copy of an update would change how both are compiled.
        let _ = row_constant(&mut default, u, y);
        let _ = row_exact(&mut exact, u, y);
    }
    rows! { meter;
        "estimate, per call", 4, *row_estimate, default, calls();
        "deviations, per call", 4, *row_std, default, calls();
        "exact estimate, per call", 4, *row_exact_estimate, exact, calls();
    }
    let nearer = FilteredTrends::for_bandwidth(Scheme::Tustin, record::SAMPLE_TIME, 22.0)?;
    rows! { meter;
        "retune, per call", 4, *row_retune, (default, nearer), calls();
    }
    Ok(())
}

/// How often a call that is not made in every sample is counted.
const CALLS: usize = 200;

fn bare<const N: usize>() -> Estimator<N> {
    Estimator::new([0.0; N], [1000.0; N], 0.999)
}

fn pulled<const N: usize>() -> Pulled<N> {
    Pulled {
        estimator: bare(),
        turn: 0,
    }
}

#[cfg(target_os = "none")]
mod target {
    use core::mem::size_of;

    use cortex_m_rt::entry;

    use super::{Meter, all, black_box};
    use crate::firmware::board::{exit, line};
    use crate::firmware::clock::{Clock, Unit};
    use crate::firmware::stack;

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        line(format_args!("{info}"));
        exit(false)
    }

    struct Counter {
        clocks: [Clock; 2],
        /// Ticks of a function of one instruction, its return.
        idle: [f32; 2],
        systick_off: bool,
    }

    impl Meter for Counter {
        fn row<S: Copy, U: Copy, R>(
            &mut self,
            name: &str,
            function: &str,
            n: usize,
            state: S,
            samples: impl Iterator<Item = (U, f32)>,
            step: impl Fn(&mut S, &U, f32) -> R,
        ) {
            let [fine, systick] = self.clocks;
            let mut sums = [0.0f64; 2];
            let (mut worst, mut peak, mut count) = (0, 0, 0);
            let mut subject = state;
            for (k, (u, y)) in samples.enumerate() {
                let (u, y) = black_box((u, y));
                // Both clocks count the same step, so one of them works on a copy.
                let mut copy = subject;
                sums[1] += f64::from(systick.ticks(|| step(black_box(&mut copy), &u, y)));
                if k % 100 == 1 {
                    let mut copy = subject;
                    peak = peak.max(stack::peak(|| step(black_box(&mut copy), &u, y)));
                }
                let ticks = fine.ticks(|| step(black_box(&mut subject), &u, y));
                sums[0] += f64::from(ticks);
                worst = worst.max(ticks);
                count += 1;
            }
            let mean = sums.map(|sum| (sum / f64::from(count)) as f32);
            if n == 0 {
                self.idle = mean;
                return;
            }
            let units =
                |clock: &Clock, i: usize, ticks: f32| clock.units(ticks - self.idle[i]) + 1.0;
            let by_fine = units(&fine, 0, mean[0]);
            let by_systick = units(&systick, 1, mean[1]);
            // Two counters with their own calibration must tell the same story. SysTick counts in steps of
            // six instructions, and in a repeatable run the part of a step does not average out.
            const STEP: f32 = 6.0;
            if (by_systick - by_fine).abs() > 0.02 * by_fine + STEP {
                self.systick_off = true;
            }
            line(format_args!(
                "{name};{function};{n};{by_fine:.1};{:.0};{by_systick:.1};{peak};{}",
                units(&fine, 0, worst as f32),
                size_of::<S>(),
            ));
        }
    }

    #[entry]
    fn main() -> ! {
        let Some(mut core) = cortex_m::Peripherals::take() else {
            exit(false)
        };
        let clocks = Clock::start(&mut core);
        for clock in clocks {
            line(format_args!(
                "# {}: {:.4} ticks per unit of {:?}",
                clock.name,
                clock.rate(),
                clock.unit
            ));
        }
        if clocks[0].unit == Unit::Cycles {
            line(format_args!(
                "# a board: processor cycles, not instructions"
            ));
        }
        let mut counter = Counter {
            clocks,
            idle: [0.0; 2],
            systick_off: false,
        };
        if let Err(error) = all(&mut counter) {
            line(format_args!("{error}"));
            exit(false);
        }
        if counter.systick_off {
            line(format_args!("# SysTick and {} disagree", clocks[0].name));
        }
        exit(!counter.systick_off)
    }
}

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), trendid::ConfigError> {
    struct Stopwatch;
    impl Meter for Stopwatch {
        fn row<S: Copy, U: Copy, R>(
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
    println!(
        "this machine, wall time; `cargo xtask icount` counts instructions on the emulated target"
    );
    all(&mut Stopwatch)
}
