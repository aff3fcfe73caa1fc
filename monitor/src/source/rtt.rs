//! The debugger's end of SEGGER's real-time transfer: a control block is found in the memory of the
//! target, and the rings that it names are read and written while the program there runs.
//!
//! The layout is that of `SEGGER_RTT_CB` (J-Link manual UM08001, chapter RTT): 16 bytes
//! `SEGGER RTT`, the numbers of channels up and down, and of each channel name, ring, size, place
//! of writing, place of reading and mode, as words of 32 bits, the least byte first. What the
//! memory says is checked: a program that ran wild gives an error and no endless reading.

/// The memory of a target.
pub(super) trait Memory {
    /// Reads all of `into`.
    fn read(&mut self, address: u32, into: &mut [u8]) -> Result<(), String>;
    /// Writes all of `bytes`.
    fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), String>;
}

/// What the block begins with.
const ID: &[u8; 16] = b"SEGGER RTT\0\0\0\0\0\0";

/// Bytes that are searched at once.
const CHUNK: usize = 1024;

/// Channels in a direction, and bytes of a ring, that are taken at most.
const CHANNELS: u32 = 16;
const SIZE: u32 = 1 << 20;

/// Bytes of the head of the block, and of a channel.
const HEAD: u32 = 24;
const CHANNEL: u32 = 24;

/// A channel in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rtt {
    up: u32,
    down: u32,
}

/// A channel as it is now.
struct Channel {
    ring: u32,
    size: u32,
    written: u32,
    read: u32,
}

impl Rtt {
    /// The channels `name` of the first control block from `begin` on that has both; `None` where
    /// there is none before the memory or `length` ends, e.g. because the program has not begun.
    pub(super) fn find(
        memory: &mut impl Memory,
        begin: u32,
        length: u32,
        name: &str,
    ) -> Result<Option<Self>, String> {
        let (mut named, mut window) = (None, Vec::new());
        let mut at = begin;
        while at < begin.saturating_add(length) {
            let mut chunk = [0; CHUNK];
            if memory.read(at, &mut chunk).is_err() {
                break;
            }
            // A block may lie over the edge of two chunks.
            let kept = window.len().min(ID.len() - 1);
            window.drain(..window.len() - kept);
            window.extend_from_slice(&chunk);
            let first = at - kept as u32;
            for (place, _) in window
                .windows(ID.len())
                .enumerate()
                .filter(|(_, w)| w == ID)
            {
                match Self::of_block(memory, first + place as u32, name) {
                    Ok(found) => return Ok(Some(found)),
                    Err(why) => named = Some(why),
                }
            }
            at += CHUNK as u32;
        }
        named.map_or(Ok(None), Err)
    }

    /// The channels of the block at `at`.
    fn of_block(memory: &mut impl Memory, at: u32, name: &str) -> Result<Self, String> {
        let head: [u32; 2] = words(memory, at + 16)?;
        let [ups, downs] = head;
        if ups > CHANNELS || downs > CHANNELS {
            return Err(format!(
                "the RTT block at {at:#x} has {ups} channels up and {downs} down, at most {CHANNELS} are taken"
            ));
        }
        let mut names = Vec::new();
        let mut places = [None; 2];
        for number in 0..ups + downs {
            let place = at + HEAD + CHANNEL * number;
            let word: [u32; 1] = words(memory, place)?;
            let found = text(memory, word[0]);
            let direction = usize::from(number >= ups);
            if found == name && places[direction].is_none() {
                places[direction] = Some(place);
            }
            names.push(found);
        }
        if let [Some(up), Some(down)] = places {
            return Ok(Self { up, down });
        }
        let down = names.split_off(ups as usize);
        Err(format!(
            "RTT has no channel `{name}` in both directions: up [{}], down [{}]",
            names.join(", "),
            down.join(", ")
        ))
    }

    /// Takes what the target has written; `limit` bytes at most.
    pub(super) fn take(
        self,
        memory: &mut impl Memory,
        limit: usize,
        into: &mut Vec<u8>,
    ) -> Result<(), String> {
        let channel = Channel::at(memory, self.up)?;
        let waits = channel.waits().min(limit as u32);
        for (place, count) in channel.parts(channel.read, waits) {
            let from = into.len();
            into.resize(from + count as usize, 0);
            memory.read(channel.ring + place, &mut into[from..])?;
        }
        if waits > 0 {
            let read = (channel.read + waits) % channel.size;
            memory.write(self.up + 16, &read.to_le_bytes())?;
        }
        Ok(())
    }

    /// Gives the target as many of `bytes` as it has room for; how many.
    pub(super) fn give(self, memory: &mut impl Memory, bytes: &[u8]) -> Result<usize, String> {
        if bytes.is_empty() {
            return Ok(0);
        }
        let channel = Channel::at(memory, self.down)?;
        let room = (channel.size - 1 - channel.waits()).min(bytes.len() as u32);
        let mut left = bytes;
        for (place, count) in channel.parts(channel.written, room) {
            let (part, rest) = left.split_at(count as usize);
            memory.write(channel.ring + place, part)?;
            left = rest;
        }
        if room > 0 {
            // The bytes stand before the target sees that there are some.
            let written = (channel.written + room) % channel.size;
            memory.write(self.down + 12, &written.to_le_bytes())?;
        }
        Ok(room as usize)
    }
}

impl Channel {
    fn at(memory: &mut impl Memory, place: u32) -> Result<Self, String> {
        let [ring, size, written, read] = words(memory, place + 4)?;
        let sound = (2..=SIZE).contains(&size)
            && written < size
            && read < size
            && ring.checked_add(size).is_some();
        if sound {
            Ok(Self {
                ring,
                size,
                written,
                read,
            })
        } else {
            Err(format!(
                "the RTT channel at {place:#x} is damaged: {size} bytes at {ring:#x}, written to {written}, read to {read}"
            ))
        }
    }

    /// Bytes that are not read yet.
    fn waits(&self) -> u32 {
        (self.written + self.size - self.read) % self.size
    }

    /// The parts of `count` bytes from `from` on, before and after the end of the ring.
    fn parts(&self, from: u32, count: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
        let first = count.min(self.size - from);
        [(from, first), (0, count - first)]
            .into_iter()
            .filter(|(_, count)| *count > 0)
    }
}

fn words<const N: usize>(memory: &mut impl Memory, at: u32) -> Result<[u32; N], String> {
    let mut bytes = vec![0; 4 * N];
    memory.read(at, &mut bytes)?;
    let mut words = bytes.chunks_exact(4);
    Ok([(); N].map(|()| match words.next() {
        Some(&[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }))
}

/// A name, as far as it can be read; empty where there is none.
fn text(memory: &mut impl Memory, at: u32) -> String {
    let mut bytes = [0; 16];
    if at == 0 || memory.read(at, &mut bytes).is_err() {
        return String::new();
    }
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(16);
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}

#[cfg(test)]
pub(super) mod tests;
