//! The firmware in QEMU over the rings of RTT. Needs an image and QEMU: `cargo xtask rtt`.

use std::net::TcpListener;
use std::process::{Child, Command, Stdio};

use super::*;

/// The image of the servo example.
fn image() -> String {
    std::env::var("IMAGE").expect("the image of the servo example in IMAGE")
}

/// Whether no sample is missing from the `from`th on.
fn complete(host: &Host, from: usize) -> bool {
    host.samples[from..]
        .windows(2)
        .all(|pair| pair[1].tick == pair[0].tick + 1)
}

/// The first sample behind a gap, from the `from`th on.
fn gap(host: &Host, from: usize) -> Option<usize> {
    let mut pairs = host.samples[from..].windows(2);
    let place = pairs.position(|pair| pair[1].tick > pair[0].tick + 1)?;
    Some(from + place + 1)
}

#[test]
#[ignore = "needs an image and QEMU"]
fn requests_and_answers_go_through_memory_and_a_lost_reader_blocks_nothing() {
    let mut host = Host::of(&["--emulator", "--rtt", "--image", &image()]);
    host.until("samples", |host| host.samples.len() > 500);
    host.until("who it is", |host| host.identity.is_some());
    assert_eq!(host.state(), Some(State::Idle));
    let refused = Outcome::Refused(Refusal::NotControlling);
    assert_eq!(host.ask(Request::Move(250.0)), refused);
    assert_eq!(host.ask(Request::Commission), Outcome::Done);
    host.until("control", Host::controls);
    assert_eq!(host.ask(Request::Move(250.0)), Outcome::Done);
    host.until("the move", |host| {
        let last = host.samples.last().unwrap();
        last.setpoint[0] == 250.0 && (last.position - 250.0).abs() < 1.0
    });
    host.until("the counters", |host| host.health.is_some());
    let losses = host.client.losses();
    assert_eq!((losses.lost, losses.corrupt, losses.unanswered), (0, 0, 0));
    assert!(complete(&host, 0));
    assert_eq!(host.health.unwrap().dropped, 0);

    // Nobody says anything, so that the watchdog of the line, of 5000 samples, stops the axis; and
    // nobody takes what the source says, which looks no more when its queue is full. The slots in
    // the image go on.
    let before = host.samples.len();
    let begin = Instant::now();
    while host.source.said.len() < host.source.said.max_capacity() {
        assert!(begin.elapsed() < PATIENCE, "the queue does not fill");
        thread::sleep(Duration::from_millis(50));
    }
    thread::sleep(Duration::from_secs(10));
    host.until("that the line was lost", |host| {
        host.events.contains(&Event::LineLost)
    });
    host.until("the stop", |host| host.state() == Some(State::Idle));
    host.until("the gap", |host| gap(host, 0).is_some());
    let behind = gap(&host, 0).unwrap();
    let far = host.samples[behind].tick;
    // Of counters that came a second later: they tell of all of it.
    host.until("the counters behind the gap", |host| {
        host.health.is_some_and(|health| health.tick > far + 1000)
    });
    assert!(complete(&host, behind));
    let missing = far - host.samples[behind - 1].tick - 1;
    let health = host.health.unwrap();
    println!(
        "over RTT: {} samples, then nobody looked: {missing} missing, {} dropped, overruns {}",
        before, health.dropped, health.overruns
    );
    assert!(missing > 500 && health.dropped >= missing);
    assert_eq!((health.events_lost, health.overruns), (0, 0));
    let losses = host.client.losses();
    assert_eq!((losses.lost, losses.corrupt), (0, 0));
}

/// The emulator; it ends with this.
struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
#[ignore = "needs an image and QEMU"]
fn a_target_that_runs_already_is_joined_left_and_joined_again() {
    let place = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = place.local_addr().unwrap().to_string();
    drop(place);
    let emulator = Command::new("qemu-system-arm")
        .args([
            "-machine",
            "netduinoplus2",
            "-nographic",
            "-monitor",
            "none",
        ])
        .args([
            "-semihosting-config",
            "enable=on,target=native,arg=image,arg=rtt",
        ])
        .args(["-serial", "null", "-gdb", &format!("tcp:{address}")])
        .args(["-kernel", &image()])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn();
    let _emulator = Emulator(emulator.expect("qemu-system-arm"));
    thread::sleep(Duration::from_secs(1));
    let mut first = Host::of(&["--gdb", &address]);
    first.until("samples", |host| host.samples.len() > 500);
    let left = first.samples.last().unwrap().tick;
    drop(first);
    // Nobody looks for longer than the ring has room for.
    thread::sleep(Duration::from_secs(3));
    let mut again = Host::of(&["--gdb", &address]);
    again.until("samples again", |host| {
        host.samples
            .last()
            .is_some_and(|last| last.tick > left + 2000)
    });
    let behind = gap(&again, 0).expect("what was dropped while nobody looked");
    again.until("samples without a gap", move |host| {
        host.samples.len() > behind + 1000
    });
    assert!(complete(&again, behind));
    assert_eq!(again.ask(Request::Acknowledge), Outcome::Done);
    assert_eq!(again.client.losses().corrupt, 0);
}
