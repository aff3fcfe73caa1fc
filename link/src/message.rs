//! The two messages.

use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Largest number of requests that travel with one sample.
pub const REQUESTS: usize = 4;

/// Number of [`Reply::fields`].
pub const FIELDS: usize = 26;

/// Values of [`Reply::state`] and [`Reply::reason`] that are no state of the loop.
pub mod code {
    /// State: there is no loop, because there was no [`Request::Reset`](crate::Request::Reset) or
    /// its set-up was refused.
    pub const NO_LOOP: u8 = 255;
    /// Reason: the state has none.
    pub const NO_REASON: u8 = 255;

    /// The number of a reason on the wire, counted from 0 in the order of
    /// [`Reason`](trendid::servo::Reason).
    #[must_use]
    pub const fn of(reason: Option<trendid::servo::Reason>) -> u8 {
        match reason {
            Some(reason) => reason as u8,
            None => NO_REASON,
        }
    }
}

/// A structure that travels in a frame.
pub trait Message: Serialize + DeserializeOwned {
    /// First byte of the body; a receiver refuses frames of the other direction.
    const TAG: u8;
}

/// The machine as its user describes it; everything else has the defaults of
/// [`trendid::servo::Config::new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Rough bandwidth of the drive in rad/s.
    pub bandwidth: f32,
    /// Begin and end of the travel in mm.
    pub travel: [f32; 2],
    /// Position of one count of the sensor in mm; code 0 is position 0.
    pub mm_per_count: f32,
    /// Dead volume of a chamber over that of the stroke, infinite for a drive of the same stiffness
    /// everywhere; `None` to find it.
    pub dead_volume: Option<f32>,
    /// Whether the model follows the drive after the commissioning.
    pub adaptive: bool,
}

/// Request to the loop before it processes a sample, outside of the 1 ms path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Start of a run: the target forgets its loop and its counters and builds a new loop.
    Reset(Setup),
    /// Commission the axis.
    Commission,
    /// Stop commissioning or control.
    Abort,
    /// Plan a move to this position in mm.
    MoveTo(f32),
    /// Oscillate about the present reference.
    Oscillate {
        /// Amplitude in mm.
        amplitude: f32,
        /// Frequency in Hz.
        frequency: f32,
    },
}

/// Host to target: one reading of the sensor, and what is asked before it is processed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Sequence number, one more for each sample, wraps.
    pub seq: u32,
    /// Position code in counts; `None` is a reading that failed.
    pub code: Option<i32>,
    /// Requests, in the order in which they are carried out.
    pub requests: heapless::Vec<Request, REQUESTS>,
}

impl Sample {
    /// Whether a new run begins with this sample.
    #[must_use]
    pub fn is_reset(&self) -> bool {
        let reset = |request: &Request| matches!(request, Request::Reset(_));
        self.requests.iter().any(reset)
    }
}

impl Message for Sample {
    const TAG: u8 = b'S';
}

/// Target to host: what the loop made of the sample with the same number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// Sequence number of the sample.
    pub seq: u32,
    /// State of the supervisor, counted from 0 in the order of [`trendid::servo::State`], or
    /// [`code::NO_LOOP`].
    pub state: u8,
    /// Reason of the state, counted from 0 in the order of [`trendid::servo::Reason`], or
    /// [`code::NO_REASON`].
    pub reason: u8,
    /// Whether a model reached the controller in this sample.
    pub retuned: bool,
    /// Valve command for the coming sample period, -1 to 1.
    pub command: f32,
    /// Measured position in mm.
    pub position: f32,
    /// Reference and its first three derivatives in mm and s.
    pub setpoint: [f32; 4],
    /// Innovation of the identifier in mm, if there was one.
    pub innovation: Option<f32>,
    /// Position, velocity and acceleration of the controller's observer in mm and s.
    pub motion: [f32; 3],
    /// Disturbance of the observer, a flow.
    pub disturbance: f32,
    /// The model in the controller: a1, a2, b0, dead zone, offset, friction.
    pub model: [f32; 6],
    /// The identifier's estimate theta, see [`trendid::servo::LoopIdentifier`].
    pub theta: [f32; 6],
    /// Faults the target has seen since the start of the run.
    pub counters: Counters,
}

impl Message for Reply {
    const TAG: u8 = b'R';
}

impl Reply {
    /// Name and bits of everything that the loop computed; number and counters are the link's.
    ///
    /// An innovation that is absent has bits that no f32 of the loop has (a signalling NaN).
    #[must_use]
    pub fn fields(&self) -> [(&'static str, u32); FIELDS] {
        let [r, r1, r2, r3] = self.setpoint.map(f32::to_bits);
        let [x, v, a] = self.motion.map(f32::to_bits);
        let [a1, a2, b0, dead_zone, offset, friction] = self.model.map(f32::to_bits);
        let theta = self.theta.map(f32::to_bits);
        [
            ("state", u32::from(self.state)),
            ("reason", u32::from(self.reason)),
            ("retuned", u32::from(self.retuned)),
            ("command", self.command.to_bits()),
            ("position", self.position.to_bits()),
            ("setpoint", r),
            ("velocity of the setpoint", r1),
            ("acceleration of the setpoint", r2),
            ("jerk of the setpoint", r3),
            (
                "innovation",
                self.innovation.map_or(0x7FA0_0000, f32::to_bits),
            ),
            ("observed position", x),
            ("observed velocity", v),
            ("observed acceleration", a),
            ("observed disturbance", self.disturbance.to_bits()),
            ("a1 in the controller", a1),
            ("a2 in the controller", a2),
            ("b0 in the controller", b0),
            ("dead zone in the controller", dead_zone),
            ("offset in the controller", offset),
            ("friction in the controller", friction),
            ("estimated a1", theta[0]),
            ("estimated a2", theta[1]),
            ("estimated b0", theta[2]),
            ("estimated b0 of sgn u", theta[3]),
            ("estimated b1 of sgn v", theta[4]),
            ("estimated constant", theta[5]),
        ]
    }
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
