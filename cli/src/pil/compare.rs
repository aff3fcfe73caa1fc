//! The loop on the target beside the one here: each sample goes to both, and what both computed is
//! compared.

use indicatif::ProgressBar;
use trendid::servo::Report;
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{DEAD_VOLUME, ROUGH_BANDWIDTH, Request, Rig, TRAVEL};
use trendid_host_tests::servo::shadow::Shadow;
use trendid_link::{
    Counters, Exchange, ExchangeError, FIELDS, Reply, Request as Asked, Sample, Setup,
};

use super::args::PilArgs;
use super::line::Disturbed;
use crate::output;

/// How often a sample is sent before the target is given up: 20 s either way, since a busy machine
/// may leave an emulator without time for a while. On a line with faults a wait is 20 ms, else 1 s.
const fn attempts(faults: bool) -> u32 {
    if faults { 1000 } else { 20 }
}

/// The target as the shadow of the scenario's loop.
pub(super) struct Target {
    /// The line, with its faults.
    pub line: Disturbed,
    exchange: Exchange,
    attempts: u32,
    asked: Vec<Asked>,
    end: Option<u32>,
    failures: Option<u32>,
    bar: ProgressBar,
    /// Samples that were compared.
    pub samples: u32,
    /// Readings that failed on purpose.
    pub failed: u32,
    /// Numbers that were the same.
    pub numbers: u64,
    /// The target's newest reply.
    pub last: Option<Reply>,
    /// Reason for which the run ended before its time.
    pub trouble: Option<String>,
}

impl Target {
    /// A target on `line` that has no loop yet; `first` is the first number of a frame.
    pub(super) fn new(line: Disturbed, first: u32, args: &PilArgs) -> Self {
        let bar = output::progress(u64::from(args.samples.unwrap_or(0)), "samples");
        if args.samples.is_none() {
            bar.unset_length();
        }
        let attempts = attempts(args.faults.is_some());
        Self {
            line,
            exchange: Exchange::new(first, attempts),
            attempts,
            asked: vec![Asked::Reset(Setup {
                bandwidth: ROUGH_BANDWIDTH,
                travel: [TRAVEL.min, TRAVEL.max],
                mm_per_count: RESOLUTION_MM as f32,
                dead_volume: Some(DEAD_VOLUME),
                adaptive: !args.fixed,
            })],
            end: args.samples,
            failures: args.failures,
            bar,
            samples: 0,
            failed: 0,
            numbers: 0,
            last: None,
            trouble: None,
        }
    }

    /// Faults that the host saw.
    pub(super) fn counters(&self) -> Counters {
        self.exchange.counters()
    }

    /// Takes the progress off the screen.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Sends a sample and gives the reply, or why there is none.
    fn reply(&mut self, code: Option<i32>) -> Result<Reply, String> {
        let requests = std::mem::take(&mut self.asked);
        let Ok(requests) = requests.as_slice().try_into() else {
            return Err(format!("{} requests are too many", requests.len()));
        };
        let sample = Sample {
            seq: 0,
            code,
            requests,
        };
        let (number, attempts) = (self.samples, self.attempts);
        self.exchange
            .exchange(&mut self.line, sample)
            .map_err(|error| match error {
                ExchangeError::Line(error) => format!("the line to the target failed: {error}"),
                ExchangeError::NoReply(_) => {
                    format!("the target did not answer sample {number} in {attempts} attempts")
                }
            })
    }
}

impl Shadow for Target {
    fn reading(&mut self, code: i32) -> Option<i32> {
        let fails = self.failures.is_some_and(|n| self.samples % n == n - 1);
        self.failed += u32::from(fails);
        (!fails).then_some(code)
    }

    fn request(&mut self, request: Request) {
        self.asked.push(match request {
            Request::Commission => Asked::Commission,
            Request::Abort => Asked::Abort,
            Request::MoveTo(target) => Asked::MoveTo(target),
            Request::Oscillate {
                amplitude,
                frequency,
            } => Asked::Oscillate {
                amplitude,
                frequency,
            },
        });
    }

    fn update(&mut self, reading: Option<i32>, report: &Report, rig: &Rig) -> Option<f32> {
        let reply = match self.reply(reading) {
            Ok(reply) => reply,
            Err(trouble) => {
                self.trouble = Some(trouble);
                return None;
            }
        };
        let difference = difference(&reply, &Reply::of(report, &rig.servo));
        if let Some(difference) = difference {
            self.trouble = Some(format!("sample {} differs: {difference}", self.samples));
            return None;
        }
        self.samples += 1;
        self.numbers += FIELDS as u64;
        self.bar.inc(1);
        let command = reply.command;
        self.last = Some(reply);
        (self.end != Some(self.samples)).then_some(command)
    }
}

/// The first number that is not the same to the last bit.
fn difference(target: &Reply, host: &Reply) -> Option<String> {
    let fields = target.fields().into_iter().zip(host.fields());
    fields
        .into_iter()
        .find(|(target, host)| target.1 != host.1)
        .map(|((name, target), (_, host))| {
            let number = |bits| format!("{bits:#010x} ({})", f32::from_bits(bits));
            format!(
                "{name} is {} on the target, {} here",
                number(target),
                number(host)
            )
        })
}
