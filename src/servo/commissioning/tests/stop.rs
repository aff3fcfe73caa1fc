//! What the record of an axis says that begins on a stop.

use super::*;

#[test]
fn what_a_stop_bore_is_no_dead_zone() {
    for (w, damping, gain, dead_zone) in [
        (12.6, 1.05, 725.0, 0.08),
        (23.0, 0.8, 85.0, 0.08),
        (20.0, 0.4, 1000.0, 0.04),
    ] {
        let model = Model {
            dead_zone,
            ..Model::linear(w * w, 2.0 * damping * w, gain * w * w)
        };
        // From both stops with both signs: the first triangle presses half of them on theirs.
        for (end, sign) in [
            (TRAVEL.min, 1.0),
            (TRAVEL.min, -1.0),
            (TRAVEL.max, 1.0),
            (TRAVEL.max, -1.0),
        ] {
            let mut plant = Plant::new(model, sign, 1);
            plant.motion = Motion::at(end);
            let ended = commissioned(design(), &mut plant, None);
            let Progress::Found(found, _) = ended.progress else {
                panic!("{w} {end} {sign}: {:?}", ended.progress);
            };
            let [closed, offset] = [found.model.dead_zone - dead_zone, found.model.offset];
            assert!(
                closed.abs() < 0.03 && offset.abs() < 0.02,
                "{w} {end} {sign}: {closed} {offset}"
            );
        }
    }
}
