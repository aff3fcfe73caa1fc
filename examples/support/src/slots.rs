//! Slots of the control loop that passed without a call, by a counter that runs on and wraps
//! around.

/// Share of a slot by which a call may be earlier in its slot than the first one was; it may be
/// later by the rest of a slot.
const MARGIN: u32 = 32;

/// The slots of a periodic interrupt.
///
/// An interrupt that is late for more than a slot is called once for all that passed: the counter
/// tells how many. The begin of a slot is carried on in whole periods, so that nothing adds up; a
/// call that is late by almost a slot may count as one too many, which is set off against the next
/// that is missing.
#[derive(Clone, Copy, Debug)]
pub struct Slots {
    /// Counts in a slot, above zero.
    period: u32,
    /// Begin of the newest slot.
    begin: u32,
    /// Calls that came before their slot.
    early: u32,
    started: bool,
}

impl Slots {
    /// Slots of `period` counts; the first call lies in the first one.
    #[must_use]
    pub const fn new(period: u32) -> Self {
        Self {
            period: if period == 0 { 1 } else { period },
            begin: 0,
            early: 0,
            started: false,
        }
    }

    /// Takes the counter at a call; how many slots passed without one since the call before.
    ///
    /// `since`: counts since the present slot began. The first call alone looks at it: that of an
    /// interrupt which waited to be let in comes anywhere in its slot, and every later one would
    /// seem early.
    pub const fn missed(&mut self, now: u32, since: u32) -> u32 {
        if !self.started {
            self.started = true;
            self.begin = now.wrapping_sub(since % self.period + self.period / MARGIN);
            return 0;
        }
        let slots = now.wrapping_sub(self.begin) / self.period;
        self.begin = self.begin.wrapping_add(slots * self.period);
        let calls = self.early + 1;
        self.early = calls.saturating_sub(slots);
        slots.saturating_sub(calls)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const PERIOD: u32 = 84_000;

    /// Missed slots, seen at calls so many counts after the first one.
    fn missed<const N: usize>(first: u32, calls: [u32; N]) -> [u32; N] {
        let mut slots = Slots::new(PERIOD);
        assert_eq!(slots.missed(first, 0), 0);
        calls.map(|after| slots.missed(first.wrapping_add(after), 0))
    }

    #[test]
    fn a_call_in_every_slot_misses_none_over_many_turns_of_the_counter() {
        let mut slots = Slots::new(PERIOD);
        let mut jitter = Random::new(1);
        let mut now = u32::MAX - 5 * PERIOD;
        for _ in 0..200_000 {
            let late = (jitter.bits() >> 8) % (9 * PERIOD / 10);
            assert_eq!(slots.missed(now.wrapping_add(late % (PERIOD / 40)), 0), 0);
            // Any lateness below a slot is none that is missing.
            now = now.wrapping_add(PERIOD);
            assert_eq!(slots.missed(now.wrapping_add(late), 0), 0);
            now = now.wrapping_add(PERIOD);
        }
    }

    #[test]
    fn slots_that_passed_are_counted_at_every_place_of_the_counter() {
        for first in [0, 1, u32::MAX - 2 * PERIOD, u32::MAX] {
            assert_eq!(missed(first, [PERIOD, 2 * PERIOD]), [0, 0]);
            assert_eq!(missed(first, [2 * PERIOD + 9, 3 * PERIOD]), [1, 0]);
            assert_eq!(missed(first, [10 * PERIOD, 11 * PERIOD]), [9, 0]);
        }
    }

    #[test]
    fn calls_and_slots_balance() {
        let end = 2 * PERIOD - 1;
        let [first, second, third] = missed(7, [end, end + 2, 3 * PERIOD]);
        assert_eq!(first + second + third, 1);
        assert_eq!(missed(7, [end, end + 2, 4 * PERIOD]), [1, 0, 0]);
        // Two calls within one slot, as after an overrun: the second belongs to the next.
        assert_eq!(missed(7, [PERIOD, PERIOD + 5, 3 * PERIOD]), [0, 0, 0]);
    }

    #[test]
    fn what_an_interrupt_misses_is_counted_wherever_it_is_let_in() {
        let mut dice = Random::new(3);
        for _ in 0..2000 {
            let mut draw = |most: u32| u64::from((dice.bits() >> 4) % most);
            let (origin, mut time) = (draw(u32::MAX), draw(PERIOD));
            let mut slots = Slots::new(PERIOD);
            let mut newest = None;
            for _ in 0..50 {
                // One request waits, however many slots have begun.
                let slot = time / u64::from(PERIOD);
                if newest == Some(slot) {
                    time = (slot + 1) * u64::from(PERIOD);
                    continue;
                }
                let since = (time % u64::from(PERIOD)) as u32;
                let missed = slots.missed((origin + time) as u32, since);
                let expected = newest.map_or(0, |before| slot - before - 1);
                // A call just before the end of its slot may count as that of the next.
                if since < PERIOD / MARGIN * (MARGIN - 1) {
                    assert_eq!(u64::from(missed), expected, "{time}");
                    newest = Some(slot);
                    let long = draw(4) == 0;
                    time += draw(if long { 4 * PERIOD } else { PERIOD / 2 });
                } else {
                    break;
                }
            }
        }
    }

    #[test]
    fn a_period_of_zero_divides_nothing() {
        let mut slots = Slots::new(0);
        assert_eq!(slots.missed(5, 7), 0);
        assert_eq!(slots.missed(8, 0), 2);
    }
}
