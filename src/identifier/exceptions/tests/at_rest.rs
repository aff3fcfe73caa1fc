//! Trends that begin at rest, where an axis stands against the model.

use super::*;
use crate::trends::Memory;

#[test]
fn where_an_axis_is_blocked_the_trends_begin_at_rest() {
    let (mut servo, drive) = trained(&config(), 3000);
    let (y, mut seen) = (drive.at[0], Seen::default());
    let mut noise = Drive::new(1e-4);
    for k in 0..400 {
        let begun = seen.begun;
        let measured = y + 1e-4 * noise.draw();
        let _ = servo.update_seen([0.3], measured, &mut seen);
        if seen.begun > begun {
            assert!(k >= 60, "{k}");
            let design = servo.plan.trends.design();
            let at = servo.state.signals.last;
            let rest = Memory::output_at_rest(design, servo.plan.output_form, at);
            assert_eq!(servo.state.signals.output, rest);
        }
    }
    assert!(seen.begun > 0);
}

#[test]
fn a_spike_behind_a_beginning_at_rest_is_replaced_and_nothing_else_enters() {
    let (mut servo, drive) = trained(&config(), 3000);
    let y = drive.at[0];
    assert!((y - 1.0).abs() > 10.0, "{y}");
    let (mut seen, mut noise, mut spikes) = (Seen::default(), Drive::new(1e-4), 0);
    let mut behind = false;
    for k in 0..4000 {
        let begun = seen.begun;
        let measured = y + 1e-3 * noise.draw() + if behind { 1.0 } else { 0.0 };
        let found = servo.update_seen([0.3], measured, &mut seen);
        assert_eq!(matches!(found, Outcome::Replaced { .. }), behind, "{k}");
        // No sample but those that were measured, and what was expected for the spike.
        let entered = servo.state.signals.last;
        assert!((entered - y).abs() < 0.1, "{k}: {entered} at {y}");
        spikes += u32::from(behind);
        behind = seen.begun > begun;
    }
    assert!(spikes > 3, "{spikes}");
}
