//! A whole run: what reaches the tools is what was recorded, and nothing is lost.

use std::collections::BTreeMap;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use clap::Parser;
use tokio::sync::mpsc::channel;

use trendid_link::telemetry::{Content, Event, Identity, NumberedEvent, Request};

use super::Hub;
use crate::args::Args;
use crate::record;
use crate::source::Said;

/// Listens until `end`; gives the datagrams.
fn listen(end: &Arc<AtomicBool>) -> (String, thread::JoinHandle<Vec<String>>) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = socket.local_addr().unwrap().to_string();
    let wait = Duration::from_millis(50);
    socket.set_read_timeout(Some(wait)).unwrap();
    let end = end.clone();
    let heard = thread::spawn(move || {
        let (mut heard, mut buffer) = (Vec::new(), [0; 2000]);
        loop {
            match socket.recv(&mut buffer) {
                Ok(count) => heard.push(String::from_utf8(buffer[..count].to_vec()).unwrap()),
                Err(_) if end.load(Ordering::Relaxed) => return heard,
                Err(_) => {}
            }
        }
    });
    (address, heard)
}

#[test]
fn record_and_tools_get_every_sample() {
    let folder = std::env::temp_dir().join(format!("trendid-hub-{}", std::process::id()));
    let path = folder.join("a.csv");
    let end = Arc::new(AtomicBool::new(false));
    let (teleplot, lines) = listen(&end);
    let (plotjuggler, objects) = listen(&end);
    let args = Args::try_parse_from([
        "monitor",
        "--axis",
        "200007",
        "--csv",
        path.to_str().unwrap(),
        "--teleplot",
        &teleplot,
        "--plotjuggler",
        &plotjuggler,
    ])
    .unwrap();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    // The end of the pages' channel would end the hub.
    let (_pages, from_pages) = channel(1);
    let summary = runtime.block_on(async {
        let hub = Hub::new(&args).unwrap();
        hub.run(from_pages, Some(Duration::from_secs(2))).await
    });
    end.store(true, Ordering::Relaxed);
    let lines = lines.join().unwrap().concat();
    let objects = objects.join().unwrap();

    let (tally, losses) = (summary.tally, summary.losses);
    assert_eq!((tally.missing, tally.dropped, tally.starts), (0, 0, 1));
    assert_eq!((losses.lost, losses.corrupt, losses.unanswered), (0, 0, 0));
    let record = record::read(&path).unwrap();
    let (rows, dt) = (record.rows, record.sample_time);
    assert!(rows.len() > 500, "{} samples in 2 s", rows.len());
    // The record begins with the first sample after it is known who speaks.
    assert!(tally.samples - rows.len() as u64 <= 100, "{tally:?}");

    // The tools get the same numbers, digit by digit.
    let mut positions = BTreeMap::new();
    for line in lines.lines() {
        let fields: Vec<&str> = line.split(':').collect();
        let [name, ms, value] = fields[..] else {
            panic!("{line}")
        };
        if name == "position" {
            let tick = (1e-3 * ms.parse::<f64>().unwrap() / dt).round() as u32;
            positions.insert(tick, value.parse::<f32>().unwrap());
        }
    }
    let mut commands = BTreeMap::new();
    for object in &objects {
        let value: serde_json::Value = serde_json::from_str(object).unwrap();
        let tick = (value["timestamp"].as_f64().unwrap() / dt).round() as u32;
        commands.insert(tick, value["command"].as_f64().unwrap() as f32);
    }
    for row in &rows {
        assert_eq!(positions.get(&row.tick), Some(&row.position), "{row:?}");
        assert_eq!(commands.get(&row.tick), Some(&row.command), "{row:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_target_is_asked_who_it_is_until_it_has_said_it() {
    let args = Args::try_parse_from(["monitor", "--axis", "200007"]).unwrap();
    let mut hub = Hub::new(&args).unwrap();
    let event = |start, number| NumberedEvent {
        start,
        number,
        oldest: 0,
        tick: 1,
        event: Event::Overrun,
    };
    assert_eq!(hub.known.alive(), Request::Hello);
    for start in [7, 8] {
        // Whoever was there before.
        hub.hear(Said::Up("a line".into()));
        assert_eq!(hub.known.alive(), Request::Hello);
        hub.take(Content::Event(event(start, 0)));
        assert_eq!(hub.known.alive(), Request::Hello);
        hub.take(Content::Identity(Identity::default()));
        hub.take(Content::Event(event(start, 1)));
        assert_eq!(hub.known.alive(), Request::Alive);
        // Another start may be another program.
        hub.take(Content::Event(event(start + 10, 0)));
        assert_eq!(hub.known.alive(), Request::Hello);
    }
}
