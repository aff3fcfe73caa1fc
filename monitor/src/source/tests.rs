//! The sources as the hub sees them: a machine behind a serial line, and a record.

mod rtt;

#[cfg(unix)]
use std::io::{Read, Write};
use std::path::Path;
#[cfg(unix)]
use std::sync::Arc;
#[cfg(unix)]
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use clap::Parser;
#[cfg(unix)]
use serialport::{SerialPort, TTYPort};
use trendid::servo::{Reason, State};
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_link::telemetry::{
    Client, Content, Event, Health, Identity, Learned, Outcome, Refusal, Request, Sample, Trick,
    reason_of, state_of,
};

use super::simulated::Simulated;
use super::{Said, Source};
use crate::args::Args;
use crate::record::{self, Recorder};

/// Time for anything here on a busy computer.
const PATIENCE: Duration = Duration::from_secs(120);

/// A source and what came of it.
struct Host {
    source: Source,
    client: Client,
    begin: Instant,
    alive: Instant,
    up: bool,
    downs: Vec<String>,
    samples: Vec<Sample>,
    events: Vec<Event>,
    answers: Vec<(u32, Outcome)>,
    learned: Option<Learned>,
    health: Option<Health>,
    identity: Option<Identity>,
}

impl Host {
    fn of(words: &[&str]) -> Self {
        let args = Args::try_parse_from(["monitor"].iter().chain(words)).unwrap();
        let now = Instant::now();
        Self {
            source: Source::start(&args).unwrap(),
            client: Client::new(1),
            begin: now,
            alive: now,
            up: false,
            downs: Vec::new(),
            samples: Vec::new(),
            events: Vec::new(),
            answers: Vec::new(),
            learned: None,
            health: None,
            identity: None,
        }
    }

    fn turn(&mut self) {
        while let Ok(said) = self.source.said.try_recv() {
            match said {
                Said::Up(_) => {
                    self.up = true;
                    self.client.disconnect();
                    for request in [Request::Hello, Request::Stream(1), Request::Watchdog(5000)] {
                        self.client.ask(request).unwrap();
                    }
                }
                Said::Down(why) => {
                    self.up = false;
                    self.client.disconnect();
                    self.downs.push(why);
                }
                Said::Bytes(bytes) => {
                    for byte in bytes {
                        self.client.push(byte).into_iter().for_each(|c| match c {
                            Content::Sample(sample) => self.samples.push(sample),
                            Content::Event(event) => self.events.push(event.event),
                            Content::Answer(answer) => {
                                self.answers.push((answer.id, answer.outcome));
                            }
                            Content::Learned(learned) => self.learned = Some(learned),
                            Content::Identity(identity) => self.identity = Some(identity),
                            Content::Health(health) => self.health = Some(health),
                            Content::Setting(_) => {}
                        });
                    }
                }
            }
        }
        if self.up && self.alive.elapsed() > Duration::from_millis(200) {
            self.alive = Instant::now();
            let _ = self.client.ask(Request::Alive);
        }
        let now = self.begin.elapsed().as_millis() as u64;
        let bytes: Vec<u8> = std::iter::from_fn(|| self.client.next_byte(now)).collect();
        if !bytes.is_empty() {
            let _ = self.source.asked.try_send(bytes);
        }
    }

    /// Waits for something.
    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let begin = Instant::now();
        while !holds(self) {
            assert!(
                begin.elapsed() < PATIENCE,
                "{what}: {:?}, last {:?}, events {:?}",
                self.downs,
                self.samples.last(),
                self.events
            );
            self.turn();
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// What came of a request.
    fn ask(&mut self, request: Request) -> Outcome {
        let id = self.client.ask(request).unwrap();
        let answered = move |host: &Self| host.answers.iter().any(|(answer, _)| *answer == id);
        self.until("an answer", answered);
        let answer = self.answers.iter().find(|(answer, _)| *answer == id);
        answer.unwrap().1.clone()
    }

    fn state(&self) -> Option<State> {
        let last = self.samples.last()?;
        state_of(last.state, last.reason)
    }

    fn controls(&self) -> bool {
        self.state().is_some_and(|state| state.is_controlling())
    }
}

fn machine() -> Simulated {
    let draw = AxisDraw::new(Family::BallScrew, true, 200_017);
    Simulated::new(&draw, "behind a line", 1).unwrap()
}

/// Runs a machine in real time at the end of a serial line until `end`.
#[cfg(unix)]
fn serve(mut port: TTYPort, end: &AtomicBool) {
    let mut machine = machine();
    port.set_timeout(Duration::from_millis(2)).unwrap();
    let (mut clock, mut bytes, mut buffer) = (Instant::now(), Vec::new(), [0; 256]);
    while !end.load(Ordering::Relaxed) {
        if let Ok(count) = port.read(&mut buffer) {
            machine.receive(&buffer[..count]);
        }
        let due = clock.elapsed().as_millis().min(50);
        clock += clock.elapsed();
        for _ in 0..due {
            machine.step();
            machine.send(&mut bytes);
        }
        // The host's end of the line takes what it takes.
        if let Ok(count) = port.write(&bytes) {
            bytes.drain(..count);
        }
    }
}

#[cfg(unix)]
#[test]
fn an_axis_behind_a_serial_line_is_commissioned_moved_broken_and_lost() {
    let (near, far) = TTYPort::pair().unwrap();
    let name = far.name().unwrap();
    let end = Arc::new(AtomicBool::new(false));
    let served = thread::spawn({
        let end = end.clone();
        move || serve(near, &end)
    });
    let mut host = Host::of(&["--port", &name]);
    host.until("samples", |host| host.samples.len() > 200);
    assert_eq!(host.state(), Some(State::Idle));
    assert_eq!(
        host.ask(Request::Move(1.0)),
        Outcome::Refused(Refusal::NotControlling)
    );
    assert_eq!(host.ask(Request::Commission), Outcome::Done);
    host.until("control", Host::controls);
    let verified = |event: &Event| matches!(event, Event::State { state: 3, .. });
    assert!(host.events.iter().any(verified), "{:?}", host.events);
    host.until("margins", |host| {
        host.learned
            .is_some_and(|learned| learned.margins.is_some())
    });
    host.until("who it is", |host| host.identity.is_some());
    let [from, to] = host.identity.as_ref().unwrap().travel;
    let target = from + 0.3 * (to - from);
    assert_eq!(host.ask(Request::Move(target)), Outcome::Done);
    host.until("the move", |host| {
        let last = host.samples.last().unwrap();
        last.setpoint[0] == target && (last.position - target).abs() < 0.005 * (to - from)
    });
    let oscillate = Request::Oscillate {
        amplitude: 0.05 * (to - from),
        frequency: 0.5,
    };
    assert_eq!(host.ask(oscillate), Outcome::Done);
    assert_eq!(host.ask(Request::Play(Trick::FreezeSensor)), Outcome::Done);
    host.until("the fault", |host| {
        matches!(host.state(), Some(State::Failed(_)))
    });
    let reason = host.samples.last().and_then(|s| reason_of(s.reason));
    assert!(
        matches!(
            reason,
            Some(Reason::SensorStuck | Reason::FollowingError | Reason::Implausible)
        ),
        "{reason:?}"
    );
    let losses = host.client.losses();
    assert_eq!((losses.lost, losses.corrupt, losses.unanswered), (0, 0, 0));
    let ticks: Vec<u32> = host.samples.iter().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1));
    end.store(true, Ordering::Relaxed);
    served.join().unwrap();
    drop(far);
    host.until("the loss of the line", |host| !host.up);
}

#[test]
fn a_record_is_shown_as_it_was_and_carries_nothing_out() {
    let folder = std::env::temp_dir().join(format!("trendid-replay-{}", std::process::id()));
    let path = folder.join("a.csv");
    let rows = recorded(&path);
    let mut host = Host::of(&["--replay", path.to_str().unwrap()]);
    host.until("the record", |host| host.samples.len() == rows.len());
    for (row, sample) in rows.iter().zip(&host.samples) {
        assert_eq!(
            (row.tick, row.state, row.position, row.setpoint),
            (
                sample.tick,
                sample.state,
                sample.position,
                sample.setpoint[0]
            )
        );
        assert_eq!(
            (row.command, row.velocity, row.innovation),
            (sample.command, sample.velocity, sample.innovation)
        );
    }
    assert_eq!(
        host.ask(Request::Commission),
        Outcome::Refused(Refusal::Unsupported)
    );
    assert_eq!(host.client.losses().lost, 0);
    std::fs::remove_dir_all(folder).unwrap();
}

/// A record of an axis that is being commissioned.
fn recorded(path: &Path) -> Vec<record::Row> {
    let (mut machine, mut client) = (machine(), Client::new(1));
    let (mut bytes, mut identity, mut recorder) = (Vec::new(), None, None);
    for ms in 0..2000 {
        if ms == 0 {
            for request in [Request::Hello, Request::Stream(1), Request::Commission] {
                client.ask(request).unwrap();
            }
        }
        let asked: Vec<u8> = std::iter::from_fn(|| client.next_byte(ms)).collect();
        machine.receive(&asked);
        machine.step();
        machine.send(&mut bytes);
        for byte in bytes.drain(..) {
            match client.push(byte) {
                Some(Content::Identity(found)) => identity = Some(found),
                Some(Content::Sample(sample)) => {
                    if let (None, Some(identity)) = (&recorder, &identity) {
                        let file = crate::claimed::Claimed::create(path.to_owned());
                        recorder = Recorder::begin(file.unwrap(), identity).ok();
                    }
                    if let Some(recorder) = &mut recorder {
                        recorder.take(&sample).unwrap();
                    }
                }
                _ => {}
            }
        }
    }
    recorder.unwrap().finish().unwrap();
    let rows = record::read(path).unwrap().rows;
    assert!(rows.len() > 1900 && rows.iter().any(|row| row.command.abs() > 0.01));
    rows
}
