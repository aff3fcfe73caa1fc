//! The telemetry as rows of the counts: what a slot tells, up to the last byte that it gives to the
//! line.

use core::hint::black_box;

use trendid_example_support::record;
use trendid_link::telemetry::{Health, Identity, Learned, Sample, Station};

use crate::meter::Meter;

/// A station that tells every sample, and the number of the sample.
type Teller = (Station, u32);

/// One sample, as a slot tells it at 1 kHz.
#[inline(never)]
// SAFETY: the name is used once in this image.
#[unsafe(no_mangle)]
fn row_telemetry(state: &mut Teller, u: f32, y: f32) -> u32 {
    let (station, tick) = state;
    *tick = tick.wrapping_add(1);
    let _ = station.sample(Sample {
        tick: *tick,
        position: y,
        setpoint: [y, u],
        velocity: u,
        command: u,
        innovation: Some(y),
        ..Sample::default()
    });
    sent(station)
}

/// What is told ten times a second besides; the reading of the loop is another row.
#[inline(never)]
// SAFETY: the name is used once in this image.
#[unsafe(no_mangle)]
fn row_learned(state: &mut Teller, u: f32, y: f32) -> u32 {
    let (station, tick) = state;
    station.learned(Learned {
        tick: *tick,
        theta: [y; 3],
        covariance: Some([y; 6]),
        model: [y; 6],
        expected: Some(u),
        margins: Some([u; 4]),
        ..Learned::default()
    });
    station.health(Health {
        tick: *tick,
        ..Health::default()
    });
    sent(station)
}

/// Gives the bytes to a line that takes them all.
fn sent(station: &mut Station) -> u32 {
    let mut count = 0;
    while let Some(byte) = station.next_byte() {
        black_box(byte);
        count += 1;
    }
    count
}

/// The rows: over `samples`, and over `calls` of what is told now and then.
#[inline(never)]
pub(crate) fn rows(
    meter: &mut impl Meter,
    samples: impl Iterator<Item = (f32, f32)>,
    calls: impl Iterator<Item = (f32, f32)>,
) {
    let identity = Identity {
        sample_time: record::SAMPLE_TIME,
        ..Identity::default()
    };
    let teller: Teller = (Station::new(identity, 1, 1), 0);
    meter.row(
        "telemetry of a sample",
        "row_telemetry",
        6,
        teller.clone(),
        samples,
        |state, &u, y| row_telemetry(state, u, y),
    );
    meter.row(
        "its estimate and counters, per call",
        "row_learned",
        6,
        teller,
        calls,
        |state, &u, y| row_learned(state, u, y),
    );
}
