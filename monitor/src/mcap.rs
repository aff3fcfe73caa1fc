//! Samples as MCAP, one JSON object each: what Foxglove and PlotJuggler open.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use trendid_link::telemetry::Sample;

use crate::outputs::object;

/// What is in an object.
const SCHEMA: &str = r#"{"type":"object","properties":{"timestamp":{"type":"number"},"position":{"type":"number"},"setpoint":{"type":"number"},"velocity":{"type":"number"},"command":{"type":"number"},"state":{"type":"number"},"innovation":{"type":"number"}}}"#;

/// A file that is being written.
pub(crate) struct Mcap {
    writer: Writer<BufWriter<File>>,
    channel: u16,
    path: PathBuf,
}

impl Mcap {
    /// Begins a file; one that is there is not overwritten.
    ///
    /// # Errors
    /// Why not, with the name of the file.
    pub(crate) fn create(path: &Path) -> Result<Self, String> {
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|error| named(&error))?;
        }
        let file = File::create_new(path).map_err(|error| named(&error))?;
        let begin = || -> Result<_, McapError> {
            let options = WriteOptions::new().compression(None);
            let mut writer = options.create(BufWriter::new(file))?;
            let schema = writer.add_schema("trendid.Sample", "jsonschema", SCHEMA.as_bytes())?;
            let channel = writer.add_channel(schema, "/sample", "json", &BTreeMap::new())?;
            Ok((writer, channel))
        };
        let (writer, channel) = begin().map_err(|error| named(&error))?;
        Ok(Self {
            writer,
            channel,
            path: path.to_owned(),
        })
    }

    /// Takes a sample; its time is that of the target since its start.
    ///
    /// # Errors
    /// Why it cannot be written; the file is of no use from there on.
    pub(crate) fn take(&mut self, sample: &Sample, sample_time: f32) -> Result<(), String> {
        let time = (f64::from(sample.tick) * f64::from(sample_time) * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: self.channel,
            sequence: sample.tick,
            log_time: time,
            publish_time: time,
        };
        self.writer
            .write_to_known_channel(&header, object(sample, sample_time).as_bytes())
            .map_err(|error| format!("{}: {error}", self.path.display()))
    }

    /// Writes the index, without which not every reader opens the file.
    ///
    /// # Errors
    /// Why not.
    pub(crate) fn finish(mut self) -> Result<(), String> {
        self.writer
            .finish()
            .map(drop)
            .map_err(|error| format!("{}: {error}", self.path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_read_again() {
        let folder = std::env::temp_dir().join(format!("trendid-mcap-{}", std::process::id()));
        let path = folder.join("a.mcap");
        let mut file = Mcap::create(&path).unwrap();
        for tick in 0..3000_u32 {
            let sample = Sample {
                tick,
                position: 0.1 * tick as f32,
                innovation: tick.is_multiple_of(2).then_some(0.25),
                ..Sample::default()
            };
            file.take(&sample, 1e-3).unwrap();
        }
        file.finish().unwrap();
        let bytes = fs::read(&path).unwrap();
        let mut count = 0_u32;
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            assert_eq!(message.channel.topic, "/sample");
            assert_eq!(message.sequence, count);
            let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
            assert_eq!(
                value["position"].as_f64().unwrap() as f32,
                0.1 * count as f32
            );
            assert_eq!(value["innovation"].is_null(), count % 2 == 1);
            count += 1;
        }
        assert_eq!(count, 3000);
        assert!(Mcap::create(&path).is_err());
        fs::remove_dir_all(folder).unwrap();
    }
}
