//! A file for the reader of recorded drives.

use std::path::Path;

use crate::bytes::Bytes;
use crate::reader::{Clock, Record};

/// Reads the bytes as a file.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let options = bytes.byte();
    let clock = Clock {
        column: if options & 1 == 0 { "t" } else { "time [ms]" },
        unit: (options & 2 != 0).then_some(1e-3),
        dt: (options & 16 != 0).then_some(0.01),
        held: options & 32 != 0,
        span: [
            (options & 64 != 0).then_some(0.05),
            (options & 128 != 0).then_some(1e3),
        ],
    };
    let names = ["u", "y", "x y"];
    let signals: Vec<String> = names
        .iter()
        .take(usize::from(options >> 2 & 3))
        .map(|name| (*name).to_owned())
        .collect();
    match Record::parse(Path::new("record.csv"), bytes.rest(), clock, &signals) {
        Ok(record) => {
            assert!(record.start.is_finite());
            assert!(record.dt.is_finite() && record.dt > 0.0, "dt {}", record.dt);
            assert_eq!(record.signals.len(), signals.len());
            let length = record.signals.first().map_or(0, Vec::len);
            for signal in &record.signals {
                assert_eq!(signal.len(), length, "signals of one length");
                assert!(signal.iter().all(|number| number.is_finite()));
            }
        }
        Err(error) => {
            let text = error.to_string();
            assert!(
                !text.is_empty() && !text.contains('\n'),
                "one sentence: {text}"
            );
        }
    }
}
