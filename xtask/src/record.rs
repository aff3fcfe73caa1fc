//! The record that host and target both run: a servo in integer arithmetic, the same bytes on every
//! machine.

const SAMPLES: usize = 5000;
const REFERENCE: i64 = 1_234_567;

/// Commands per period of the pseudo-random sequence.
const HOLD: usize = 50;

/// Full command in the units of the record.
const FULL: i64 = 32_768;

/// Steps of the simulation per millisecond.
const STEPS: i64 = 64;

/// Six bytes a sample, little endian: command as i16, position as i32 in micrometres.
///
/// The plant is x''' + 20 x'' + 400 x' = 10^6 u in mm, with a command of +-0.4, +-10 um of uniform
/// noise and an offset of the valve of 2 % of full command. Position, velocity and acceleration are
/// fixed-point numbers with 20 binary places of a micrometre; one step is 1/64 ms of the symplectic
/// Euler scheme. The plant of this record is close to the reference plant and not equal to it,
/// which is no matter: what is compared is bits.
pub(crate) fn bytes() -> Vec<u8> {
    const ONE: i64 = 1 << 20;
    let mut bytes = Vec::with_capacity(SAMPLES * 6);
    let (mut x, mut v, mut a) = (0i64, 0i64, 0i64);
    let mut register = 0x5EEDu32;
    let mut bits = || {
        register = register.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        register >> 8
    };
    let mut u = 0;
    for k in 0..SAMPLES {
        if k % HOLD == 0 {
            u = if bits() & 0x8000 == 0 {
                13_107
            } else {
                -13_107
            };
        }
        let noise = i64::from(bits() % 21) - 10;
        bytes.extend((u as i16).to_le_bytes());
        bytes.extend(((REFERENCE + x / ONE + noise) as i32).to_le_bytes());
        let valve = u + FULL / 50;
        for _ in 0..STEPS {
            // 10^9 um/s^3 per unit of command are 32 10^9 of 2^-20 um/s^3 per unit of the record.
            let jerk = 32_000_000_000 * valve - 20 * a - 400 * v;
            a += jerk / (1000 * STEPS);
            v += a / (1000 * STEPS);
            x += v / (1000 * STEPS);
        }
    }
    bytes
}
