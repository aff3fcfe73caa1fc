//! The wire over RTT: the rings that a debugger reads and writes while the program runs.

use crate::debugger::{REQUESTS, RTT, TELEMETRY, WIRE};
use crate::wire::line::Line;

/// Both ends are memory: the slot reads and writes it, the debugger does the rest.
pub(crate) struct Rtt;

impl Line for Rtt {
    fn receive(&mut self) -> Option<u8> {
        let channel = &RTT.down[WIRE];
        REQUESTS.take(&channel.written, &channel.read)
    }

    fn send(&mut self, bytes: impl Iterator<Item = u8>) {
        let channel = &RTT.up[WIRE];
        let room = TELEMETRY.room(&channel.written, &channel.read);
        let mut frame = TELEMETRY.begin(&channel.written);
        // There is room for all of them: the debugger only makes more.
        for byte in bytes.take(room) {
            TELEMETRY.put(&mut frame, byte, &channel.read);
        }
        TELEMETRY.end(frame, &channel.written);
    }
}
