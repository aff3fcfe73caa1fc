//! Control that begins with a record, while the position is measured already.

use super::bench::{self, Bench, DELAY, MODEL};
use crate::servo::error::Error;
use crate::servo::motion::Motion;
use crate::servo::store::Record;
use crate::servo::supervision::state::Reason;

/// What a commissioning of this drive finds.
const RECORD: Record = Record {
    model: MODEL,
    std: [f32::INFINITY; 6],
    delay: 1e-3 * DELAY as f32,
    sign: 1.0,
    noise: 2e-4,
    dead_volume: f32::INFINITY,
};

#[test]
fn the_measured_motion_goes_on_behind_a_record() {
    for position in [20.0, 200.0, 380.0] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        bench.motion = Motion::at(position);
        // Long enough for the filter to forget where the bench began.
        for _ in 0..500 {
            let _ = bench.step();
        }
        let before = bench.servo.moves.tracking.motion();
        bench.servo.resume(&RECORD).expect("a record");
        assert_eq!(bench.servo.moves.tracking.motion(), before);
        for _ in 0..500 {
            let (report, y) = bench.step();
            assert!(report.state.is_controlling(), "{:?}", report.state);
            assert!(report.command.abs() < 0.02, "{}", report.command);
            assert!((y - position).abs() < 0.05, "{y}");
        }
        assert_eq!(
            bench.servo.guard.monitors.counters().implausible_readings,
            0
        );
    }
}

#[test]
fn a_record_before_the_first_reading_begins_at_that_reading() {
    let axis = bench::axis();
    let sensor = bench::Code((300.0 / bench::SCALE) as i32);
    let servo = bench::Loop::try_new(&Bench::config(), axis, sensor, bench::Spool(0.0));
    let mut servo = servo.expect("settings");
    servo.resume(&RECORD).expect("a record");
    assert_eq!(servo.move_to(100.0), Err(Error::NotControlling));
    for _ in 0..100 {
        let report = servo.update();
        assert!((report.setpoint.position - 300.0).abs() < 1e-3);
        assert!(report.command.abs() < 0.02, "{}", report.command);
    }
    assert_eq!(servo.moves.tracking.motion().velocity, 0.0);
}

#[test]
fn a_motion_that_nothing_would_come_of_is_refused() {
    let asked = |bench: &mut Bench| [bench.servo.move_to(100.0), bench.servo.oscillate(10.0, 1.0)];
    let refused = [Err(Error::NotControlling); 2];
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    assert_eq!(asked(&mut bench), refused);
    bench.servo.commission();
    let _ = bench.step();
    assert_eq!(asked(&mut bench), refused);
    bench.servo.fail(Reason::TravelEnd);
    assert_eq!(asked(&mut bench), refused);
    bench.servo.install(MODEL).expect("a model");
    assert_eq!(asked(&mut bench), [Ok(()); 2]);
}
