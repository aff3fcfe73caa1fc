//! A push button in a slot of 1 ms: debounced, a short press and a long one, and nothing from a
//! button that was never released.

/// What a person asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Begin to move: a short press.
    Run,
    /// Stop: any press while it moves, at its begin; who is afraid does not let go.
    Stop,
    /// The fault was seen: a long press.
    Acknowledge,
}

/// Samples in a row after which a level counts.
const DEBOUNCE: u32 = 30;

/// Samples after which a press is long.
const LONG: u32 = 2000;

/// A push button.
#[derive(Clone, Copy, Debug, Default)]
pub struct Button {
    /// The level that counts; unknown until it was stable once.
    level: Option<bool>,
    /// Samples in a row that had the other level.
    other: u32,
    /// Samples for which the button is held; none when it was held from the start or the press was
    /// used.
    held: Option<u32>,
}

impl Button {
    /// One sample.
    ///
    /// A short press counts when it ends, a long one while it lasts, one that stops what `moves`
    /// when it begins. A button that is held at the start counts after it was released, but for a
    /// stop.
    pub fn update(&mut self, pressed: bool, moves: bool) -> Option<Request> {
        if self.level == Some(pressed) {
            self.other = 0;
        } else {
            self.other += 1;
            if self.other >= DEBOUNCE {
                return self.turn(pressed, moves);
            }
        }
        let held = self.held.as_mut()?;
        *held += 1;
        if *held < LONG {
            return None;
        }
        self.held = None;
        Some(Request::Acknowledge)
    }

    /// The level has changed.
    fn turn(&mut self, pressed: bool, moves: bool) -> Option<Request> {
        let before = self.level.replace(pressed);
        self.other = 0;
        if pressed && moves {
            self.held = None;
            return Some(Request::Stop);
        }
        if pressed {
            self.held = before.map(|_| 0);
            return None;
        }
        self.held.take().map(|_| Request::Run)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a sequence of levels and their lengths asks for: the first request and the number of
    /// requests.
    fn requests(levels: &[(bool, u32)]) -> (Option<Request>, usize) {
        of(levels, false)
    }

    /// The same, of a machine that moves or not.
    fn of(levels: &[(bool, u32)], moves: bool) -> (Option<Request>, usize) {
        let mut button = Button::default();
        let samples = levels
            .iter()
            .flat_map(|&(level, samples)| (0..samples).map(move |_| level));
        let mut found = samples.filter_map(|level| button.update(level, moves));
        let first = found.next();
        (first, first.map_or(0, |_| 1 + found.count()))
    }

    #[test]
    fn a_short_press_is_one_request_at_its_end() {
        let press = [(false, 100), (true, 300)];
        assert_eq!(requests(&press), (None, 0));
        let released = [(false, 100), (true, 300), (false, 100)];
        assert_eq!(requests(&released), (Some(Request::Run), 1));
    }

    #[test]
    fn a_long_press_is_one_request_however_long_it_lasts() {
        for after in [0, 100] {
            let press = [(false, 100), (true, 10 * LONG), (false, after)];
            assert_eq!(requests(&press), (Some(Request::Acknowledge), 1));
        }
    }

    #[test]
    fn a_press_stops_what_moves_at_once_and_asks_for_nothing_else() {
        for before in [[].as_slice(), &[(false, 100)]] {
            for held in [DEBOUNCE, 300, 10 * LONG] {
                for after in [0, 100] {
                    let press = [before, &[(true, held), (false, after)]].concat();
                    assert_eq!(of(&press, true), (Some(Request::Stop), 1), "{held}");
                }
            }
        }
        // It was stopped by this press, and begins again with the next one.
        let mut button = Button::default();
        let mut moves = true;
        let mut asked = |pressed, samples: u32| {
            let mut last = None;
            for _ in 0..samples {
                let request = button.update(pressed, moves);
                moves &= request.is_none();
                last = request.or(last);
            }
            last
        };
        assert_eq!(asked(false, 100), None);
        assert_eq!(asked(true, 100), Some(Request::Stop));
        assert_eq!(asked(false, 100), None);
        assert_eq!(
            (asked(true, 100), asked(false, 100)),
            (None, Some(Request::Run))
        );
    }

    #[test]
    fn contacts_bounce() {
        let bounce = [(true, 3), (false, 2), (true, 7), (false, 29)];
        let mut levels = [(false, 100); 1 + 2 * 4 + 3];
        levels[1..5].copy_from_slice(&bounce);
        levels[5] = (true, 200);
        levels[6..10].copy_from_slice(&bounce);
        levels[10] = (false, 200);
        assert_eq!(requests(&levels), (Some(Request::Run), 1));
    }

    /// The contacts bounce for less than the level takes to count, also behind that.
    #[test]
    fn a_bounce_behind_a_level_that_counts_is_no_release() {
        let pressed = [(false, 100), (true, DEBOUNCE)];
        for bounce in [1, DEBOUNCE - 1] {
            let levels = [&pressed[..], &[(false, bounce), (true, 1)]].concat();
            assert_eq!(requests(&levels), (None, 0), "{bounce}");
            assert_eq!(of(&levels, true), (Some(Request::Stop), 1), "{bounce}");
        }
    }

    #[test]
    fn a_disturbance_is_no_press() {
        let mut levels = [(false, 100); 200];
        levels
            .iter_mut()
            .step_by(2)
            .for_each(|level| *level = (true, DEBOUNCE - 1));
        assert_eq!(requests(&levels), (None, 0));
    }

    #[test]
    fn a_button_that_is_held_at_the_start_asks_for_nothing() {
        assert_eq!(requests(&[(true, 5 * LONG)]), (None, 0));
        assert_eq!(requests(&[(true, 500), (false, 500)]), (None, 0));
        let again = [(true, 500), (false, 500), (true, 500), (false, 500)];
        assert_eq!(requests(&again), (Some(Request::Run), 1));
    }
}
