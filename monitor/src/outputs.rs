//! Samples for other tools over UDP: Teleplot's lines, PlotJuggler's JSON.

use std::fmt::Write;
use std::net::{SocketAddr, UdpSocket};

use trendid_link::telemetry::Sample;

/// Longest datagram that no usual network splits.
const DATAGRAM: usize = 1400;

/// What a tool reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Format {
    /// `name:ms:value` in lines.
    Teleplot,
    /// One JSON object per datagram.
    Json,
}

/// A tool that samples are sent to.
pub(crate) struct Output {
    socket: UdpSocket,
    format: Format,
    text: String,
}

impl Output {
    /// # Errors
    /// Why there is no socket.
    pub(crate) fn new(to: SocketAddr, format: Format) -> Result<Self, String> {
        let from = if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
        let socket = UdpSocket::bind(from)
            .and_then(|socket| socket.connect(to).map(|()| socket))
            .and_then(|socket| socket.set_nonblocking(true).map(|()| socket))
            .map_err(|error| format!("{to}: {error}"))?;
        Ok(Self {
            socket,
            format,
            text: String::new(),
        })
    }

    /// Takes a sample.
    pub(crate) fn take(&mut self, sample: &Sample, sample_time: f32) {
        let text = line(self.format, sample, sample_time);
        if self.text.len() + text.len() > DATAGRAM || self.format == Format::Json {
            self.flush();
        }
        self.text += &text;
    }

    /// Sends what waits. A datagram that nobody takes is gone: the tool is not there.
    pub(crate) fn flush(&mut self) {
        if !self.text.is_empty() {
            let _ = self.socket.send(self.text.as_bytes());
            self.text.clear();
        }
    }
}

/// A sample as one JSON object.
#[cfg(feature = "mcap")]
pub(crate) fn object(sample: &Sample, sample_time: f32) -> String {
    line(Format::Json, sample, sample_time)
}

fn line(format: Format, sample: &Sample, sample_time: f32) -> String {
    let t = f64::from(sample.tick) * f64::from(sample_time);
    let mut values = vec![
        ("position", sample.position),
        ("setpoint", sample.setpoint[0]),
        ("velocity", sample.velocity),
        ("command", sample.command),
        ("state", f32::from(sample.state)),
    ];
    values.extend(sample.innovation.map(|e| ("innovation", e)));
    // Neither format has other numbers, and another program than ours may send some.
    values.retain(|(_, value)| value.is_finite());
    let mut text = String::new();
    // Writing into a string cannot fail.
    match format {
        Format::Teleplot => {
            for (name, value) in values {
                let _ = writeln!(text, "{name}:{:.3}:{value}", 1e3 * t);
            }
        }
        Format::Json => {
            let _ = write!(text, "{{\"timestamp\":{t:.6}");
            for (name, value) in values {
                let _ = write!(text, ",\"{name}\":{value}");
            }
            text.push('}');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_tools_get_every_number() {
        let sample = Sample {
            tick: 1500,
            position: 2.5,
            innovation: Some(-0.125),
            ..Sample::default()
        };
        let lines = line(Format::Teleplot, &sample, 1e-3);
        assert!(lines.contains("position:1500.000:2.5\n"), "{lines}");
        assert_eq!(lines.lines().count(), 6);
        let json: serde_json::Value =
            serde_json::from_str(&line(Format::Json, &sample, 1e-3)).unwrap();
        let bad = Sample {
            position: f32::NAN,
            velocity: f32::INFINITY,
            ..sample
        };
        let left: serde_json::Value =
            serde_json::from_str(&line(Format::Json, &bad, 1e-3)).unwrap();
        assert!(left["position"].is_null() && left["innovation"] == -0.125);
        assert_eq!(json["position"], 2.5);
        assert_eq!(json["innovation"], -0.125);
        assert!((json["timestamp"].as_f64().unwrap() - 1.5).abs() < 1e-5);
    }

    #[test]
    fn datagrams_arrive() {
        let tool = UdpSocket::bind("127.0.0.1:0").unwrap();
        let timeout = std::time::Duration::from_secs(5);
        tool.set_read_timeout(Some(timeout)).unwrap();
        let mut output = Output::new(tool.local_addr().unwrap(), Format::Teleplot).unwrap();
        output.take(&Sample::default(), 1e-3);
        output.flush();
        let mut buffer = [0; 2000];
        let count = tool.recv(&mut buffer).unwrap();
        assert!(buffer[..count].starts_with(b"position:0.000:0\n"));
    }
}
