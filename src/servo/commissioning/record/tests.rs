//! Points of a record, whatever its stride.

use super::*;

/// A record of `samples` whose position counts them and whose command is their square.
fn taken(record: &mut MotionRecord, samples: usize) {
    for k in 0..samples {
        record.push(k as f32, (k * k) as f32);
    }
}

/// The mean of the squares of `stride` samples from `begin` on.
fn mean(begin: usize, stride: usize) -> f32 {
    (begin..begin + stride).map(|k| (k * k) as f32).sum::<f32>() / stride as f32
}

#[test]
fn a_point_is_a_position_and_the_mean_command_behind_it() {
    let mut record = MotionRecord::new();
    record.restart(3);
    taken(&mut record, 3 * 100 + 2);
    assert_eq!((record.end(), record.stride()), (100, 3));
    for i in 0..100 {
        assert_eq!(record.y(i), (3 * i) as f32);
        assert!((record.u(i, 0) / mean(3 * i, 3) - 1.0).abs() < 1e-6);
        assert_eq!(
            record.u(i, i + 1),
            0.0,
            "before the first the valve was at rest"
        );
    }
    assert_eq!(record.u(7, 3), record.u(4, 0));
    // A point that was begun is forgotten with the others.
    record.restart(2);
    assert_eq!(record.end(), 0);
    record.push(5.0, 1.0);
    record.push(6.0, 3.0);
    assert_eq!((record.end(), record.y(0), record.u(0, 0)), (1, 5.0, 2.0));
}

#[test]
fn a_full_record_doubles_its_stride_and_keeps_all_that_it_saw() {
    let mut record = MotionRecord::new();
    taken(&mut record, POINTS - 1);
    assert_eq!((record.end(), record.stride()), (POINTS - 1, 1));
    let mut record = MotionRecord::new();
    taken(&mut record, 3 * POINTS);
    assert_eq!((record.end(), record.stride()), (3 * POINTS / 4, 4));
    for i in 0..record.end() {
        assert_eq!(record.y(i), (4 * i) as f32);
        assert!((record.u(i, 0) / mean(4 * i, 4) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_fixed_record_loses_its_oldest_points() {
    let mut record = MotionRecord::new();
    taken(&mut record, 64);
    // From 1 to 2 to 4; 8 would be more than 7.
    assert!(!record.fix(7) && !record.fix(7) && record.fix(7));
    assert_eq!((record.stride(), record.end()), (4, 16));
    for k in 64..4 * 700 {
        record.push(k as f32, (k * k) as f32);
    }
    assert_eq!((record.stride(), record.end()), (4, 700));
    for i in 700 - POINTS..700 {
        assert_eq!(record.y(i), (4 * i) as f32);
        assert!((record.u(i, 0) / mean(4 * i, 4) - 1.0).abs() < 1e-5);
        assert_eq!(record.u(i + 1, 1), record.u(i, 0));
    }
}
