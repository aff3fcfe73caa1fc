//! How a session goes: samples per second and memory, over all of its time.

use std::time::{Duration, Instant};

use trendid_link::telemetry::Losses;

use crate::hub::said::Tally;

const SECOND: Duration = Duration::from_secs(1);

/// After this time everything that has a bound has reached it.
const FULL: Duration = Duration::from_secs(60);

/// What is measured once a second.
pub(super) struct Course {
    begin: Instant,
    second: (Instant, u64),
    /// Samples of the last second.
    pub(super) rate: u64,
    /// Whether the line was there when this second began.
    up: bool,
    /// Whether it was there all of the last second, and brought no sample: what is shown is old.
    pub(super) silent: bool,
    rates: Option<[u64; 2]>,
    first: Option<u64>,
    full: Option<u64>,
}

impl Course {
    pub(super) fn new(now: Instant) -> Self {
        Self {
            begin: now,
            second: (now, 0),
            rate: 0,
            up: false,
            silent: false,
            rates: None,
            first: resident(),
            full: None,
        }
    }

    /// Whether a second is over, after so many `samples`; `up` while the line is there.
    pub(super) fn turn(&mut self, now: Instant, samples: u64, up: bool) -> bool {
        let (begin, count) = self.second;
        let length = now.duration_since(begin);
        if length < SECOND {
            return false;
        }
        self.rate = ((samples - count) as f64 / length.as_secs_f64()).round() as u64;
        if self.up && up && count > 0 {
            let [least, most] = self.rates.unwrap_or([self.rate; 2]);
            self.rates = Some([least.min(self.rate), most.max(self.rate)]);
        }
        self.silent = self.up && up && samples == count;
        self.up = up;
        self.second = (now, samples);
        if self.full.is_none() && now.duration_since(self.begin) >= FULL {
            self.full = resident();
        }
        true
    }

    pub(super) fn finish(self, tally: Tally, losses: Losses) -> Summary {
        Summary {
            tally,
            losses,
            seconds: self.begin.elapsed().as_secs_f64(),
            rates: self.rates,
            memory: [self.first, self.full, resident()],
            unrecorded: None,
            up: Ok(String::new()),
        }
    }
}

/// What came in, for the end.
pub(crate) struct Summary {
    pub tally: Tally,
    pub losses: Losses,
    pub seconds: f64,
    /// Least and most samples of a second.
    pub rates: Option<[u64; 2]>,
    /// Resident memory in kB at the begin, after a minute and at the end.
    pub memory: [Option<u64>; 3],
    /// Why a record does not hold all that was received.
    pub unrecorded: Option<String>,
    /// What the line leads to at the end, or why it is not there.
    pub up: Result<String, String>,
}

impl Summary {
    /// What a session of `asked` seconds, or one without an end, did not do.
    ///
    /// # Errors
    /// A record that does not hold all, or nothing that was received.
    pub(crate) fn check(&self, asked: Option<f64>) -> Result<(), String> {
        if let Some(why) = &self.unrecorded {
            return Err(why.clone());
        }
        match (asked, &self.up, self.tally.samples) {
            (Some(seconds), Ok(line), 0) => Err(format!("{line}: no sample in {seconds} s")),
            (Some(seconds), Err(why), 0) => Err(format!("no sample in {seconds} s: {why}")),
            _ => Ok(()),
        }
    }

    /// For the terminal.
    pub(crate) fn text(&self) -> String {
        let (tally, losses) = (&self.tally, &self.losses);
        let mut text = format!(
            "{:.1} s, starts of the line {}, samples {} ({:.1} per s), missing {}, dropped at the target {}, events {}\n",
            self.seconds,
            tally.starts,
            tally.samples,
            tally.samples as f64 / self.seconds,
            tally.missing,
            tally.dropped,
            tally.events
        );
        text += &format!(
            "frames lost on the line {}, damaged {}, orders without an answer {}\n",
            losses.lost, losses.corrupt, losses.unanswered
        );
        if let Some([least, most]) = self.rates {
            text += &format!("samples of a second: {least} at least, {most} at most\n");
        }
        if let [Some(first), full, Some(last)] = self.memory {
            let full = full.map_or(String::new(), |kb| format!("{kb} kB after a minute, "));
            text +=
                &format!("resident memory: {first} kB at the begin, {full}{last} kB at the end\n");
        }
        text
    }
}

/// Resident memory in kB of this program, where the system says it.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_of_a_second_counts_while_the_line_is_there() {
        let begin = Instant::now();
        let at = |ms| begin + Duration::from_millis(ms);
        let mut course = Course::new(begin);
        assert!(!course.turn(at(999), 10, true));
        // The line came within the first second; then a second of 1000, one of 950, and one in
        // which the line was lost.
        assert!(course.turn(at(1000), 500, true));
        assert_eq!((course.rate, course.rates), (500, None));
        assert!(course.turn(at(2000), 1500, true));
        assert!(course.turn(at(4000), 3400, true));
        assert_eq!(course.rate, 950);
        assert!(course.turn(at(5000), 3500, false));
        assert!(course.turn(at(6000), 3500, true));
        assert_eq!(course.rates, Some([950, 1000]));
        let text = course.finish(Tally::default(), Losses::default()).text();
        assert!(text.contains("950 at least, 1000 at most"), "{text}");
    }

    #[test]
    fn a_line_that_brings_no_sample_is_silent() {
        let begin = Instant::now();
        let mut course = Course::new(begin);
        let seconds = [
            // The line is there for a part of the first second only.
            (0, true, false),
            (0, true, true),
            (1, true, false),
            (1, true, true),
            (1, false, false),
            (1, true, false),
            (1, true, true),
            (900, true, false),
        ];
        for (second, (samples, up, silent)) in (1..).zip(seconds) {
            assert!(course.turn(begin + second * SECOND, samples, up));
            assert_eq!(course.silent, silent, "{second}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_that_is_used_shows() {
        let before = resident().unwrap();
        let used = vec![1_u8; 64 << 20];
        let after = resident().unwrap();
        assert!(
            after >= before + 60_000,
            "{before} {after} {}",
            used[1 << 20]
        );
    }
}
