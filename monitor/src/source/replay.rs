//! A record that the monitor has written, in its own time: the same wire, and no request is carried
//! out.

use std::thread;
use std::time::{Duration, Instant};

use trendid_link::code;
use trendid_link::telemetry::{Identity, Outcome, Refusal, Sample, Station};

use crate::record::Rows;
use crate::source::channel::{Line, Said};

pub(super) fn run(rows: &Rows, name: &str, mut line: Line) {
    let identity = Identity {
        name: "record".try_into().unwrap_or_default(),
        unit: rows.unit.as_str().try_into().unwrap_or_default(),
        sample_time: rows.sample_time as f32,
        travel: rows.travel,
        simulated: false,
    };
    line.say(Said::Up(format!("record {name}")));
    let mut station = Station::new(identity, std::process::id() as u16, 1);
    let (begin, mut bytes) = (Instant::now(), Vec::new());
    let mut rows_left = rows.rows.iter();
    let mut done = 0_u32;
    while line.lives() {
        while let Some(asked) = line.take() {
            for byte in asked {
                if station.push(byte).is_some() {
                    station.answer(Outcome::Refused(Refusal::Unsupported));
                }
            }
        }
        let due = (begin.elapsed().as_secs_f64() / rows.sample_time) as u32;
        // Each row leaves the station before the next one comes: however late this thread is, none
        // is lost.
        while done < due
            && line.has_room()
            && let Some(row) = rows_left.next()
        {
            done += 1;
            let _ = station.sample(Sample {
                tick: row.tick,
                state: row.state,
                reason: row.reason.unwrap_or(code::NO_REASON),
                retuned: false,
                position: row.position,
                setpoint: [row.setpoint, 0.0],
                velocity: row.velocity,
                command: row.command,
                innovation: row.innovation,
            });
            bytes.extend(std::iter::from_fn(|| station.next_byte()));
        }
        bytes.extend(std::iter::from_fn(|| station.next_byte()));
        if !bytes.is_empty() && line.has_room() {
            line.say(Said::Bytes(std::mem::take(&mut bytes)));
        }
        thread::sleep(Duration::from_millis(2));
    }
}
