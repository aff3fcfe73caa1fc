//! The record of 5 000 samples that host and target both run; `cargo xtask docs` holds it against
//! its generator, byte for byte.

/// Sample time in s.
pub const SAMPLE_TIME: f32 = 0.001;

/// Number of samples.
pub const SAMPLES: usize = 5000;

/// Counts of the position sensor at the start of the drive.
pub const REFERENCE: i32 = 1_234_567;

/// Six bytes a sample, little endian: command as i16 (32 768 is full), position as i32 in
/// micrometres.
static BYTES: &[u8; SAMPLES * 6] = include_bytes!("../../data/servo.bin");

/// The samples: command -1..1 and position in mm from the reference.
///
/// Every conversion is exact or rounded once, so host and target start from the same bits.
pub fn samples() -> impl Iterator<Item = (f32, f32)> {
    let (samples, _) = BYTES.as_chunks::<6>();
    samples.iter().map(|&[u0, u1, y0, y1, y2, y3]| {
        let u = i16::from_le_bytes([u0, u1]);
        let y = i32::from_le_bytes([y0, y1, y2, y3]) - REFERENCE;
        (f32::from(u) * (1.0 / 32_768.0), y as f32 * 0.001)
    })
}
