//! Drawn axes that are asked to the very ends of a travel which is the whole stroke.

use trendid_host_tests::servo::population::adaptive::LoopPositioner;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::range::Purpose;
use trendid_host_tests::servo::population::sequence::Exercise;

/// The first seed: none was used to tune anything.
const FIRST: u64 = 230_001;

/// Blow to an end that counts \[mm/s\].
const BLOW: f64 = 50.0;

/// What came of moves to both ends.
#[derive(Debug, Default)]
struct Arrivals {
    axes: usize,
    struck: usize,
    hardest: f64,
    stopped: usize,
    /// Times until the reference is at an end \[s\].
    times: Vec<f64>,
}

impl Arrivals {
    fn median_time(&mut self) -> f64 {
        self.times.sort_by(f64::total_cmp);
        self.times.get(self.times.len() / 2).copied().unwrap_or(0.0)
    }
}

/// A move from the middle to an end: the time until the reference is there, and the blow.
fn arrive(bench: &mut Bench, positioner: &mut LoopPositioner, end: f64) -> (Option<f64>, f64) {
    const SETTLE: f64 = 1.5;
    let stroke = bench.axis().stroke_mm();
    let mut exercise = Exercise::new(bench, positioner);
    let middle = exercise.step(0.5 * stroke, 1.0, 0.5);
    exercise.bench.blow_mm_s = 0.0;
    let begun = exercise.bench.time();
    let came = middle.and_then(|_| exercise.step(end * stroke, SETTLE, 0.5));
    let time = came.map(|_| exercise.bench.time() - begun - SETTLE);
    (time, bench.blow_mm_s)
}

/// Moves each axis from the middle to an end, back, and to the other one.
fn moved(family: Family, usual: bool, axes: u64) -> Arrivals {
    let mut seen = Arrivals::default();
    for seed in FIRST..FIRST + axes {
        let axis = AxisDraw::new(family, usual, seed);
        let mut bench = Bench::new(&axis, Purpose::Disturbance);
        let mut positioner = LoopPositioner::new(&axis, true).expect("settings");
        if positioner.commission(&mut bench).verified_s.is_none() {
            continue;
        }
        seen.axes += 1;
        let first = (seed % 2) as f64;
        let mut hardest = 0.0_f64;
        for end in [first, 1.0 - first] {
            let (time, blow) = arrive(&mut bench, &mut positioner, end);
            hardest = hardest.max(blow);
            let Some(time) = time else {
                println!("{family:?} {seed}: {:?}", positioner.stopped());
                seen.stopped += 1;
                break;
            };
            seen.times.push(time);
        }
        if hardest > BLOW {
            println!("{family:?}, usual {usual}, {seed}: {hardest:.0} mm/s");
            seen.struck += 1;
        }
        seen.hardest = seen.hardest.max(hardest);
    }
    seen
}

#[test]
fn drives_without_friction_come_to_their_ends_slowly() {
    for family in [Family::Linear, Family::BallScrew] {
        let seen = moved(family, true, 8);
        assert_eq!((seen.axes, seen.struck), (8, 0), "{family:?}: {seen:?}");
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn a_move_to_the_very_end_arrives_slowly() {
    for family in Family::ALL {
        for usual in [true, false] {
            let mut seen = moved(family, usual, 60);
            let median = seen.median_time();
            println!(
                "{family:?}, usual {usual}: {} of {} struck, hardest {:.0} mm/s, {} stopped, {median:.3} s",
                seen.struck, seen.axes, seen.hardest, seen.stopped
            );
            // Friction lets an axis hop; of a quick one 0.03 of its gain is more than what counts.
            let most = match (family, usual) {
                (_, false) => 28,
                (Family::Pneumatic | Family::SingleRod, true) => 20,
                _ => 6,
            };
            assert!(seen.struck <= most, "{family:?}, usual {usual}");
        }
    }
}
