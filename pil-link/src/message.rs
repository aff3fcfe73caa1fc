//! The two messages.

use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Largest number of parameters in a reply.
pub const PARAMETERS: usize = 8;

/// Bits of [`Sample::flags`].
pub mod flags {
    /// Start of a run: the target forgets its state and its counters before it processes this sample.
    pub const RESET: u8 = 1;
    /// The measurement is known to be bad; the target must refuse it.
    pub const INVALID: u8 = 2;
}

/// Values of [`Reply::status`]: what the identifier did with the sample.
pub mod status {
    /// The identifier is filling its buffers.
    pub const WARMING_UP: u8 = 0;
    /// The parameters were updated.
    pub const ESTIMATED: u8 = 1;
    /// The sample was taken, the parameters were kept.
    pub const HELD: u8 = 2;
    /// The sample was refused.
    pub const REFUSED: u8 = 3;
}

/// A structure that travels in a frame.
pub trait Message: Serialize + DeserializeOwned {
    /// First byte of the body; a receiver refuses frames of the other direction.
    const TAG: u8;
}

/// Host to target: one measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Sequence number, one more for each sample, wraps.
    pub seq: u32,
    /// Measured position in the unit of the model.
    pub y: f32,
    /// See [`flags`].
    pub flags: u8,
}

impl Message for Sample {
    const TAG: u8 = b'S';
}

/// Target to host: what the controller made of the sample with the same number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// Sequence number of the sample.
    pub seq: u32,
    /// Valve command for the coming sample period, -1 to 1.
    pub u: f32,
    /// Innovation of the identifier; zero unless the status is [`status::ESTIMATED`].
    pub innovation: f32,
    /// Parameters in the order and the unit of the identifier.
    pub parameters: heapless::Vec<f32, PARAMETERS>,
    /// See [`status`].
    pub status: u8,
    /// Faults the target has seen since the start of the run.
    pub counters: Counters,
}

impl Message for Reply {
    const TAG: u8 = b'R';
}

/// Faults of the link since the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Frames with a wrong length, check sum or tag.
    pub corrupt: u32,
    /// Sequence numbers that never came.
    pub lost: u32,
    /// Samples that came again after they had been processed.
    pub repeated: u32,
}
