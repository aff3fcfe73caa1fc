//! A control block in memory of the test, and what a target does with its rings.

use super::*;

/// Begin of the memory of the tests.
pub(in crate::source) const RAM: u32 = 0x2000_0000;

/// Memory with a control block at `RAM + 0x3F8`, over the edge of two chunks: log and telemetry up,
/// telemetry down.
#[derive(Clone)]
pub(in crate::source) struct Ram(pub(in crate::source) Vec<u8>);

impl Memory for Ram {
    fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), String> {
        let at = address.wrapping_sub(RAM) as usize;
        let part = self.0.get(at..at.saturating_add(into.len()));
        into.copy_from_slice(part.ok_or("no memory")?);
        Ok(())
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), String> {
        let at = address.wrapping_sub(RAM) as usize;
        let part = self.0.get_mut(at..at.saturating_add(bytes.len()));
        part.ok_or("no memory")?.copy_from_slice(bytes);
        Ok(())
    }
}

const BLOCK: u32 = RAM + 0x3F8;
const UP: u32 = BLOCK + HEAD + CHANNEL;
const DOWN: u32 = UP + 2 * CHANNEL;
const RINGS: [u32; 2] = [RAM + 0x600, RAM + 0x700];
const SIZES: [u32; 2] = [64, 32];

impl Ram {
    pub(in crate::source) fn new() -> Self {
        let mut ram = Self(vec![0xA5; 4 * CHUNK]);
        // Where names stand, a copy of the first bytes without a block behind it.
        ram.put(RAM + 0x100, b"defmt\0telemetry\0");
        ram.put(RAM + 0x180, ID);
        ram.put(BLOCK, ID);
        ram.words(BLOCK + 16, &[2, 2]);
        ram.words(BLOCK + HEAD, &[RAM + 0x100, RAM + 0x500, 16, 0, 0, 0]);
        ram.words(UP, &[RAM + 0x106, RINGS[0], SIZES[0], 0, 0, 0]);
        ram.words(DOWN - CHANNEL, &[0; 6]);
        ram.words(DOWN, &[RAM + 0x106, RINGS[1], SIZES[1], 0, 0, 0]);
        ram
    }

    fn put(&mut self, address: u32, bytes: &[u8]) {
        self.write(address, bytes).unwrap();
    }

    fn words(&mut self, address: u32, words: &[u32]) {
        for (k, word) in (0..).zip(words) {
            self.put(address + 4 * k, &word.to_le_bytes());
        }
    }

    /// What the target does: it writes up as much as there is room for.
    pub(in crate::source) fn say(&mut self, bytes: &mut Vec<u8>) {
        let channel = Channel::at(self, UP).unwrap();
        let room = (channel.size - 1 - channel.waits()).min(bytes.len() as u32);
        for (k, byte) in (0..).zip(bytes.drain(..room as usize)) {
            let place = (channel.written + k) % channel.size;
            self.put(channel.ring + place, &[byte]);
        }
        self.words(UP + 12, &[(channel.written + room) % channel.size]);
    }

    /// What the target does: it takes what came down.
    pub(in crate::source) fn hear(&mut self) -> Vec<u8> {
        let channel = Channel::at(self, DOWN).unwrap();
        let mut heard = Vec::new();
        for k in 0..channel.waits() {
            let mut byte = [0];
            let place = (channel.read + k) % channel.size;
            self.read(channel.ring + place, &mut byte).unwrap();
            heard.push(byte[0]);
        }
        self.words(DOWN + 16, &[channel.written]);
        heard
    }
}

#[test]
fn the_block_is_found_behind_what_only_looks_like_one() {
    let mut ram = Ram::new();
    let found = Rtt::find(&mut ram, RAM, 1 << 20, "telemetry");
    assert_eq!(found, Ok(Some(Rtt { up: UP, down: DOWN })));
    let why = Rtt::find(&mut ram, RAM, 1 << 20, "other").unwrap_err();
    assert!(
        why.contains("up [defmt, telemetry], down [, telemetry]"),
        "{why}"
    );
    // Before the program has begun.
    assert_eq!(
        Rtt::find(&mut Ram(vec![0; 4096]), RAM, 4096, "telemetry"),
        Ok(None)
    );
    ram.words(BLOCK + 16, &[2, 1 << 30]);
    let why = Rtt::find(&mut ram, RAM, 1 << 20, "telemetry").unwrap_err();
    assert!(why.contains("1073741824 down"), "{why}");
}

#[test]
fn bytes_go_both_ways_over_the_ends_of_the_rings() {
    let mut ram = Ram::new();
    let rtt = Rtt::find(&mut ram, RAM, 1 << 20, "telemetry")
        .unwrap()
        .unwrap();
    let mut number = 0_u8;
    for count in (0..300).map(|k: u32| (7 * k % 90) as u8) {
        let said: Vec<u8> = (0..count).map(|k| number.wrapping_add(k)).collect();
        number = number.wrapping_add(count);
        let (mut waits, mut taken) = (said.clone(), Vec::new());
        while taken.len() < said.len() {
            ram.say(&mut waits);
            let before = taken.len();
            rtt.take(&mut ram, 40, &mut taken).unwrap();
            assert!((1..=40).contains(&(taken.len() - before)));
        }
        assert_eq!(taken, said);
        let (mut given, mut heard) = (0, Vec::new());
        while given < said.len() {
            given += rtt.give(&mut ram, &said[given..]).unwrap();
            heard.extend(ram.hear());
        }
        assert_eq!(heard, said);
    }
    // A target that does not take gets no more than there is room for.
    assert_eq!(
        rtt.give(&mut ram, &[1; 100]).unwrap(),
        SIZES[1] as usize - 1
    );
    assert_eq!(rtt.give(&mut ram, &[1; 100]).unwrap(), 0);
}

#[test]
fn a_channel_that_is_damaged_is_refused() {
    let sound = Ram::new();
    let rtt = Rtt::find(&mut sound.clone(), RAM, 1 << 20, "telemetry")
        .unwrap()
        .unwrap();
    for (word, value) in [
        (4, u32::MAX - 3),
        (8, 0),
        (8, 1),
        (8, u32::MAX),
        (12, 64),
        (16, 1000),
    ] {
        let mut ram = sound.clone();
        ram.words(UP + word, &[value]);
        ram.words(DOWN + word, &[value]);
        let mut taken = Vec::new();
        assert!(
            rtt.take(&mut ram, 100, &mut taken).is_err(),
            "{word} {value}"
        );
        assert!(rtt.give(&mut ram, b"x").is_err(), "{word} {value}");
        assert!(taken.is_empty());
    }
}
