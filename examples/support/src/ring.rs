//! Bytes between the program and a debugger that may be slow or absent, in either direction: nobody
//! waits.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// A ring of `N` bytes with one writer and one reader, one of which moves its place behind the back
/// of the other.
///
/// What a frame has written is shown to the reader when it ends. A frame that has no room is
/// dropped whole and counted; who may not lose any asks for the [`room`](Self::room) first.
#[derive(Debug)]
pub struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    lost: AtomicU32,
}

/// A frame that is being written.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    at: u32,
    fits: bool,
}

impl Frame {
    /// Nothing is written.
    pub const NONE: Self = Self { at: 0, fits: false };
}

impl<const N: usize> Default for Ring<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Ring<N> {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(N > 1 && N <= u32::MAX as usize) };
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            lost: AtomicU32::new(0),
        }
    }

    /// Where the bytes stand, for the reader.
    #[must_use]
    pub const fn as_ptr(&self) -> *const u8 {
        self.bytes.as_ptr().cast()
    }

    /// Frames that were dropped.
    pub fn lost(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }

    /// Bytes that a frame may have now.
    pub fn room(&self, written: &AtomicU32, read: &AtomicU32) -> usize {
        let [written, read] =
            [written, read].map(|place| place.load(Ordering::Acquire) as usize % N);
        (read + N - written - 1) % N
    }

    /// The next byte that the other end has written.
    pub fn take(&self, written: &AtomicU32, read: &AtomicU32) -> Option<u8> {
        let at = read.load(Ordering::Relaxed) as usize % N;
        if at == written.load(Ordering::Acquire) as usize % N {
            return None;
        }
        let byte = self.bytes.get(at)?.load(Ordering::Relaxed);
        read.store(((at + 1) % N) as u32, Ordering::Release);
        Some(byte)
    }

    /// Begins a frame behind what was `written`.
    pub fn begin(&self, written: &AtomicU32) -> Frame {
        Frame {
            at: written.load(Ordering::Relaxed) % N as u32,
            fits: true,
        }
    }

    /// Takes a byte of the frame; `read` is how far the reader came.
    pub fn put(&self, frame: &mut Frame, byte: u8, read: &AtomicU32) {
        let next = (frame.at + 1) % N as u32;
        frame.fits &= next != read.load(Ordering::Acquire) % N as u32;
        if frame.fits
            && let Some(place) = self.bytes.get(frame.at as usize)
        {
            place.store(byte, Ordering::Relaxed);
            frame.at = next;
        }
    }

    /// Shows the frame to the reader, or counts it as lost.
    pub fn end(&self, frame: Frame, written: &AtomicU32) {
        if frame.fits {
            written.store(frame.at, Ordering::Release);
        } else {
            self.lost
                .store(self.lost().saturating_add(1), Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    const SIZE: usize = 16;

    /// The ring with its two places, as writer and reader see them.
    #[derive(Default)]
    struct Line {
        ring: Ring<SIZE>,
        written: AtomicU32,
        read: AtomicU32,
    }

    impl Line {
        fn write(&self, bytes: &[u8]) {
            let mut frame = self.ring.begin(&self.written);
            bytes
                .iter()
                .for_each(|&byte| self.ring.put(&mut frame, byte, &self.read));
            self.ring.end(frame, &self.written);
        }

        fn take(&self) -> Vec<u8> {
            std::iter::from_fn(|| self.ring.take(&self.written, &self.read)).collect()
        }

        fn room(&self) -> usize {
            self.ring.room(&self.written, &self.read)
        }
    }

    #[test]
    fn frames_come_through_whole_and_in_order_over_many_turns() {
        let line = Line::default();
        for k in 0..1000_u32 {
            let bytes: Vec<u8> = (0..k % 14).map(|i| (i + k) as u8).collect();
            line.write(&bytes);
            assert_eq!(line.take(), bytes);
        }
        assert_eq!(line.ring.lost(), 0);
    }

    #[test]
    fn a_reader_that_never_reads_costs_frames_and_no_time() {
        let line = Line::default();
        // A writer that waited would not come back from here.
        for _ in 0..1000 {
            line.write(&[1, 2, 3, 4]);
        }
        assert_eq!(line.take(), [1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4]);
        assert_eq!(line.ring.lost(), 1000 - 3);
        line.write(&[5, 6]);
        assert_eq!(line.take(), [5, 6]);
    }

    #[test]
    fn a_frame_that_does_not_fit_leaves_no_part_of_itself() {
        let line = Line::default();
        line.write(&[1; SIZE - 3]);
        line.write(&[2; 3]);
        line.write(&[3; 2]);
        assert_eq!(line.take(), [[1; SIZE - 3].as_slice(), &[3; 2]].concat());
        line.write(&[4; SIZE]);
        assert_eq!(line.take(), []);
        assert_eq!(line.ring.lost(), 2);
    }

    #[test]
    fn a_frame_of_the_room_that_is_left_fits_and_one_byte_more_does_not() {
        let line = Line::default();
        for k in 0..1000 {
            let some = k % SIZE;
            line.write(&[1; SIZE][..some.min(line.room())]);
            let room = line.room();
            assert_eq!(room + some, SIZE - 1);
            line.write(&[2; SIZE][..room + 1]);
            assert_eq!((line.room(), line.ring.lost()), (room, k as u32 + 1));
            line.write(&[3; SIZE][..room]);
            assert_eq!((line.room(), line.ring.lost()), (0, k as u32 + 1));
            assert_eq!(
                line.take(),
                [&[1; SIZE][..some], &[3; SIZE][..room]].concat()
            );
            // The next turn begins elsewhere.
            line.write(&[4]);
            assert_eq!(line.take(), [4]);
        }
    }

    #[test]
    fn places_that_a_debugger_spoilt_are_wrapped_into_the_ring() {
        let line = Line::default();
        line.read.store(u32::MAX, Ordering::Relaxed);
        line.written.store(u32::MAX - 3, Ordering::Relaxed);
        assert!(line.room() < SIZE);
        line.write(&[7, 8]);
        assert!(line.written.load(Ordering::Relaxed) < SIZE as u32);
        line.written.store(u32::MAX, Ordering::Relaxed);
        line.read
            .store(u32::MAX - SIZE as u32 - 2, Ordering::Relaxed);
        assert!(line.take().len() < SIZE && line.take().is_empty());
    }
}
