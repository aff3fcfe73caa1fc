//! What a slot may do for the watchdog, and when the machine stops: the decisions of `servo`, apart
//! from the chip.
//!
//! | slot | fed | else |
//! |---|---|---|
//! | in time, fresh reading, no fault | yes | |
//! | in time, no fresh reading | no | ten of them end in a restart |
//! | late | no | |
//! | the third in a row that was late or missing, or behind it | no | stops |
//! | fault of sensor, valve or axis | no | stops |
//! | stopped, in time, safe output written | yes | the fault can be read |

use trendid::servo::Reason;

/// Slots in a row that were late or missing and end in the safe output.
pub const OVERRUNS: u32 = 3;

/// One slot in control, as it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Slots that passed before this one began.
    pub missed: u32,
    /// Whether the next slot had begun when this one ended.
    pub late: bool,
    /// Whether the sensor gave a reading.
    pub fresh: bool,
    /// A fault of the machine, by its name.
    pub fault: Option<&'static str>,
}

/// What follows from a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The watchdog is fed.
    Feed,
    /// The watchdog is not fed.
    Starve,
    /// The safe output, for this reason, until a person has acknowledged it.
    Stop(&'static str),
}

/// Watches over the slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guard {
    in_a_row: u32,
}

impl Guard {
    /// Begins without an overrun.
    #[must_use]
    pub const fn new() -> Self {
        Self { in_a_row: 0 }
    }

    /// Judges a slot in control.
    pub const fn control(&mut self, slot: &Slot) -> Verdict {
        if let Some(fault) = slot.fault {
            return Verdict::Stop(fault);
        }
        self.in_a_row = self.in_a_row.saturating_add(slot.missed);
        if slot.late {
            self.in_a_row = self.in_a_row.saturating_add(1);
        }
        if self.in_a_row >= OVERRUNS {
            return Verdict::Stop("overruns in a row");
        }
        if slot.late {
            return Verdict::Starve;
        }
        self.in_a_row = 0;
        if slot.fresh {
            Verdict::Feed
        } else {
            Verdict::Starve
        }
    }

    /// Judges a slot of a stopped machine; `safe`: the safe output was written.
    #[must_use]
    pub const fn rest(safe: bool, late: bool) -> Verdict {
        if safe && !late {
            Verdict::Feed
        } else {
            Verdict::Starve
        }
    }
}

/// The reasons that are a fault of the machine: all but those for which a model was refused, after
/// which a new request may commission, and the person who stopped it. Each is as short as what
/// survives a restart ([`Text`](crate::survivor::Text)).
#[must_use]
pub const fn fault(reason: Reason) -> Option<&'static str> {
    Some(match reason {
        Reason::NotFinite
        | Reason::OutOfRange
        | Reason::Unstable
        | Reason::Uncertain
        | Reason::PoorFit
        | Reason::NotBetter
        | Reason::Aborted => return None,
        Reason::SensorFault => "the sensor reported errors",
        Reason::ValveFault => "the valve reported an error",
        Reason::SensorStuck => "the sensor is stuck",
        Reason::ValveStuck => "the valve is stuck",
        Reason::Blocked => "the axis is blocked",
        Reason::WrongSign => "a wrong sign, or a lost supply",
        Reason::TravelEnd => "the axis came to its end",
        Reason::Implausible => "the position jumped",
        Reason::FollowingError => "the axis does not follow",
        Reason::Saturated => "the full command lasts too long",
        // A reason that this list does not know is no reason to move.
        _ => "a fault of the loop",
    })
}

/// Whether something that counts goes on: what feeds a watchdog besides may run while it hangs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    seen: u32,
}

impl Progress {
    /// Begins at a count of zero.
    #[must_use]
    pub const fn new() -> Self {
        Self { seen: 0 }
    }

    /// Whether the count is another one than at the last look.
    pub const fn goes_on(&mut self, count: u32) -> bool {
        let goes_on = count != self.seen;
        self.seen = count;
        goes_on
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::survivor::Text;

    const GOOD: Slot = Slot {
        missed: 0,
        late: false,
        fresh: true,
        fault: None,
    };
    const LATE: Slot = Slot { late: true, ..GOOD };
    const BLIND: Slot = Slot {
        fresh: false,
        ..GOOD
    };

    /// The verdict on the last of these slots.
    fn last(slots: &[Slot]) -> Verdict {
        let mut guard = Guard::default();
        let mut verdict = Verdict::Starve;
        for slot in slots {
            verdict = guard.control(slot);
        }
        verdict
    }

    #[test]
    fn only_a_slot_in_time_with_a_reading_and_without_a_fault_feeds() {
        for missed in [0, 1, OVERRUNS, u32::MAX] {
            for late in [false, true] {
                for fresh in [false, true] {
                    for fault in [None, Some("the valve is stuck")] {
                        let slot = Slot {
                            missed,
                            late,
                            fresh,
                            fault,
                        };
                        let feeds = missed < OVERRUNS && !late && fresh && fault.is_none();
                        assert_eq!(last(&[slot]) == Verdict::Feed, feeds, "{slot:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_refuses_a_model_or_is_a_person_is_no_fault_and_all_else_is_one() {
        let none = [
            Reason::NotFinite,
            Reason::OutOfRange,
            Reason::Unstable,
            Reason::Uncertain,
            Reason::PoorFit,
            Reason::NotBetter,
            Reason::Aborted,
        ];
        assert_eq!(none.map(fault), [None; 7]);
        let faults = [
            Reason::WrongSign,
            Reason::Blocked,
            Reason::ValveStuck,
            Reason::SensorStuck,
            Reason::SensorFault,
            Reason::ValveFault,
            Reason::TravelEnd,
            Reason::Implausible,
            Reason::FollowingError,
            Reason::Saturated,
        ];
        let words = faults.map(|reason| fault(reason).unwrap_or_default());
        for (place, text) in words.iter().enumerate() {
            assert!(!text.is_empty() && !words[..place].contains(text), "{text}");
            // It is read behind a restart as it was.
            assert_eq!(Text::end_of(text).as_str(), *text);
        }
    }

    #[test]
    fn what_hangs_makes_no_progress() {
        let mut progress = Progress::new();
        // Before its first sample, in the course, over the wrap, and when it hangs.
        let counts = [0, 0, 1, 3, 3, 4, u32::MAX, 0, 1, 1, 1];
        let goes_on = counts.map(|count| progress.goes_on(count));
        let expected = [
            false, false, true, true, false, true, true, true, true, false, false,
        ];
        assert_eq!(goes_on, expected);
    }

    #[test]
    fn three_overruns_in_a_row_stop_and_two_do_not() {
        let stop = Verdict::Stop("overruns in a row");
        assert_eq!(last(&[LATE, LATE]), Verdict::Starve);
        assert_eq!(last(&[LATE, LATE, LATE]), stop);
        assert_eq!(last(&[LATE, LATE, GOOD, LATE, LATE]), Verdict::Starve);
        assert_eq!(last(&[LATE, LATE, GOOD]), Verdict::Feed);
    }

    #[test]
    fn a_missing_slot_counts_as_much_as_a_late_one() {
        let after = |missed| Slot { missed, ..GOOD };
        // A slot of 2.5 ms is late, and one is missing after it.
        assert_eq!(last(&[LATE, after(1)]), Verdict::Feed);
        assert_eq!(last(&[LATE, after(2)]), Verdict::Stop("overruns in a row"));
        assert_eq!(last(&[after(u32::MAX)]), Verdict::Stop("overruns in a row"));
    }

    #[test]
    fn a_fault_stops_even_in_a_late_slot() {
        let fault = Slot {
            fault: Some("the sensor is stuck"),
            ..LATE
        };
        assert_eq!(last(&[fault]), Verdict::Stop("the sensor is stuck"));
    }

    #[test]
    fn slots_without_a_reading_starve_the_watchdog_for_good() {
        assert_eq!(last(&[BLIND; 20]), Verdict::Starve);
        assert_eq!(last(&[BLIND, GOOD]), Verdict::Feed);
    }

    #[test]
    fn a_stopped_machine_stays_stopped_while_its_safe_output_is_written() {
        assert_eq!(Guard::rest(true, false), Verdict::Feed);
        assert_eq!(Guard::rest(false, false), Verdict::Starve);
        assert_eq!(Guard::rest(true, true), Verdict::Starve);
    }
}
