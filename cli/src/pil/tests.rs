//! The comparison against a target in this process, which may also compute wrongly or be dead.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};

use clap::Parser;
use trendid_host_tests::servo::figures::Figures;
use trendid_host_tests::servo::run::{Options, run_with_shadow};
use trendid_host_tests::servo::scenario::Scenario;
use trendid_link::{Controller, FIELDS, Incoming, Responder};

use super::PilArgs;
use super::compare::Target;
use super::line::Disturbed;

/// The image without its processor.
#[derive(Default)]
struct Here {
    responder: Responder,
    controller: Controller,
    samples: u32,
    /// The sample in whose code one count is wrong.
    wrong: Option<u32>,
    inbox: VecDeque<u8>,
}

impl Write for Here {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        for &byte in bytes {
            let answer = match self.responder.push(byte) {
                Some(Incoming::New(mut sample)) => {
                    if self.wrong == Some(self.samples) {
                        sample.code = sample.code.map(|code| code + 1);
                    }
                    self.samples += 1;
                    self.responder.answer(self.controller.update(&sample))
                }
                Some(Incoming::Repeated) => self.responder.cached(),
                Some(Incoming::Stale) | None => &[],
            };
            self.inbox.extend(answer);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Read for Here {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        match self.inbox.pop_front() {
            Some(byte) => {
                bytes[0] = byte;
                Ok(1)
            }
            None => Err(ErrorKind::TimedOut.into()),
        }
    }
}

#[derive(clap::Parser)]
struct Words {
    #[command(flatten)]
    pil: PilArgs,
}

fn run(target: Here, scenario: Scenario, options: &[&str]) -> (Target, Figures) {
    let args = Words::try_parse_from([&["pil"], options].concat()).expect("options");
    let line = Disturbed::new(Box::new(target), args.pil.faults, args.pil.seed);
    let mut target = Target::new(line, u32::MAX - 100, &args.pil);
    let options = Options {
        fixed: args.pil.fixed,
        ..Options::adaptive(args.pil.seed)
    };
    let figures = run_with_shadow(scenario, &options, &mut target, &mut |_, _| {});
    (target, figures)
}

#[test]
fn a_run_compares_every_field_of_every_sample() {
    let (target, figures) = run(Here::default(), Scenario::Nominal, &["--samples", "2600"]);
    assert_eq!(target.trouble, None);
    assert_eq!(target.samples, 2600);
    assert_eq!(target.numbers, 2600 * FIELDS as u64);
    assert!(figures.verified_at_s.is_some());
}

#[test]
fn a_bad_line_and_a_bad_sensor_change_no_number() {
    let options = ["--samples", "1300", "--failures", "600", "--seed", "5"];
    let (clean, _) = run(Here::default(), Scenario::Nominal, &options);
    let disturbed = [&options[..], &["--faults", "6"]].concat();
    let (bad, _) = run(Here::default(), Scenario::Nominal, &disturbed);
    for target in [&clean, &bad] {
        assert_eq!(target.trouble, None);
        assert_eq!((target.samples, target.failed), (1300, 2));
    }
    let fields = |target: &Target| target.last.as_ref().map(|reply| reply.fields());
    assert_eq!(fields(&clean), fields(&bad));
    assert_eq!((clean.line.injected, clean.counters().lost), (0, 0));
    assert!(bad.line.injected > 100 && bad.counters().lost > 20);
}

#[test]
fn fixed_gains_reach_the_target() {
    let (target, figures) = run(
        Here::default(),
        Scenario::Nominal,
        &["--samples", "3000", "--fixed"],
    );
    assert_eq!(target.trouble, None);
    assert_eq!(figures.accepted, 1);
}

#[test]
fn a_fault_of_the_axis_is_refused_on_the_target_too() {
    let (target, figures) = run(Here::default(), Scenario::StuckValve, &[]);
    assert_eq!(target.trouble, None);
    let expected = Scenario::StuckValve.expected().expect("a fault");
    let reason = target.last.map(|reply| reply.reason);
    assert!(
        expected.iter().any(|r| reason == Some(*r as u8)),
        "{}",
        figures.state
    );
}

#[test]
fn one_wrong_count_is_found_and_ends_the_run() {
    let wrong = Here {
        wrong: Some(400),
        ..Here::default()
    };
    let (target, _) = run(wrong, Scenario::Nominal, &[]);
    assert_eq!(target.samples, 400);
    let trouble = target.trouble.expect("a difference");
    // In commissioning the command is the excitation; the position differs first.
    assert!(
        trouble.starts_with("sample 400 differs: position is "),
        "{trouble}"
    );
}

#[test]
fn a_dead_target_is_given_up() {
    struct Dead;
    impl Read for Dead {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(ErrorKind::TimedOut.into())
        }
    }
    impl Write for Dead {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let args = Words::try_parse_from(["pil"]).expect("options");
    let line = Disturbed::new(Box::new(Dead), None, 1);
    let mut target = Target::new(line, 1, &args.pil);
    let options = Options::adaptive(1);
    let _ = run_with_shadow(Scenario::Nominal, &options, &mut target, &mut |_, _| {});
    assert_eq!(
        target.trouble.as_deref(),
        Some("the target did not answer sample 0 in 20 attempts")
    );
}
