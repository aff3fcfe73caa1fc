//! Consistent overhead byte stuffing: S. Cheshire and M. Baker, IEEE/ACM Transactions on Networking 7(2), 1999.

/// Writes the stuffed form of `body` to `wire` and gives its length; `wire` holds `body.len() + 1` bytes at least.
///
/// Bodies here are shorter than 254 bytes, so one code byte is added and no run is ever split.
pub(crate) fn encode(body: &[u8], wire: &mut [u8]) -> usize {
    let mut code = 0;
    let mut end = 1;
    for &byte in body {
        if byte == 0 {
            wire[code] = (end - code) as u8;
            code = end;
        } else {
            wire[end] = byte;
        }
        end += 1;
    }
    wire[code] = (end - code) as u8;
    end
}

/// Undoes the stuffing of a frame byte by byte.
#[derive(Clone, Debug, Default)]
pub(crate) struct Decoder {
    /// Bytes left until the next code byte.
    run: u8,
    started: bool,
}

impl Decoder {
    /// Takes one byte that is not zero; gives the byte of the body it stands for, if it stands for one.
    pub(crate) fn push(&mut self, byte: u8) -> Option<u8> {
        if self.run == 0 {
            // A code byte: a zero of the body, except for the first of the frame.
            self.run = byte - 1;
            let zero = self.started.then_some(0);
            self.started = true;
            zero
        } else {
            self.run -= 1;
            Some(byte)
        }
    }

    /// Whether a delimiter may come now: no byte of the last run is missing.
    pub(crate) fn complete(&self) -> bool {
        self.run == 0
    }

    /// Whether no byte has come since the last delimiter.
    pub(crate) fn is_empty(&self) -> bool {
        !self.started
    }
}
