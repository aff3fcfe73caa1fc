//! CRC-32 of a frame.

/// CRC-32 of IEEE 802.3 (reflected polynomial 0xEDB88320, start and final inversion), four bits a step.
///
/// ```
/// assert_eq!(trendid_link::crc32(b"123456789"), 0xCBF4_3926);
/// ```
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        crc = NIBBLES[(crc & 15) as usize] ^ (crc >> 4);
        crc = NIBBLES[(crc & 15) as usize] ^ (crc >> 4);
    }
    !crc
}

/// Remainders of the sixteen values of four bits: 64 bytes of flash instead of the 1 KiB of a byte table.
const NIBBLES: [u32; 16] = {
    let mut table = [0; 16];
    let mut value = 0;
    while value < 16 {
        let mut crc = value as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
            bit += 1;
        }
        table[value] = crc;
        value += 1;
    }
    table
};
