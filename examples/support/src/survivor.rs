//! What survives a reset in memory that the start does not clear: counted resets, and a fault until
//! it is acknowledged.

use crate::hash::Hash;
use crate::reset::{Cause, Causes};

/// Bytes of a text in the record.
const TEXT: usize = 32;

/// The end of a text, at most 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text([u8; TEXT]);

impl Text {
    /// The end of `text`, as much as there is room for; begins at a whole character.
    #[must_use]
    pub fn end_of(text: &str) -> Self {
        let mut begin = text.len().saturating_sub(TEXT);
        while !text.is_char_boundary(begin) {
            begin += 1;
        }
        let mut bytes = [0; TEXT];
        for (place, byte) in bytes.iter_mut().zip(text.bytes().skip(begin)) {
            *place = byte;
        }
        Self(bytes)
    }

    /// The text; empty where the bytes are none.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let length = self.0.iter().position(|&byte| byte == 0).unwrap_or(TEXT);
        let bytes = self.0.get(..length).unwrap_or_default();
        core::str::from_utf8(bytes).unwrap_or_default()
    }

    fn words(&self) -> [u32; TEXT / 4] {
        let (words, _) = self.0.as_chunks::<4>();
        core::array::from_fn(|i| words.get(i).map_or(0, |&word| u32::from_le_bytes(word)))
    }

    fn from_words(words: &[u32; TEXT / 4]) -> Self {
        let mut bytes = [0; TEXT];
        let (places, _) = bytes.as_chunks_mut::<4>();
        for (place, word) in places.iter_mut().zip(words) {
            *place = word.to_le_bytes();
        }
        Self(bytes)
    }
}

/// What ended a run; the machine stays stopped until a person has acknowledged it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The program stopped the machine.
    Stopped {
        /// Why.
        why: Text,
    },
    /// A watchdog restarted the chip, and nothing was recorded before.
    Watchdog,
    /// The program gave up.
    Panic {
        /// Line of the source.
        line: u32,
        /// End of the path of the source.
        file: Text,
    },
    /// The processor gave up.
    HardFault {
        /// Address of the instruction.
        pc: u32,
        /// Return address, of the caller or of an exception.
        lr: u32,
    },
    /// The stack had no room left.
    StackOverflow {
        /// Where the stack pointer was.
        sp: u32,
    },
    /// An exception or interrupt that nobody handles.
    Exception {
        /// Number of the interrupt, negative for an exception of the core.
        number: i32,
    },
    /// The record was damaged while power was there: what it held is not known.
    Forgotten,
}

/// Words of a fault: kind, two numbers, text.
const FAULT: usize = 3 + TEXT / 4;

impl Fault {
    fn words(fault: Option<&Self>) -> [u32; FAULT] {
        const EMPTY: Text = Text([0; TEXT]);
        let (kind, first, second, text) = match fault {
            None => (0, 0, 0, &EMPTY),
            Some(Self::Stopped { why }) => (1, 0, 0, why),
            Some(Self::Watchdog) => (2, 0, 0, &EMPTY),
            Some(Self::Panic { line, file }) => (3, *line, 0, file),
            Some(Self::HardFault { pc, lr }) => (4, *pc, *lr, &EMPTY),
            Some(Self::Exception { number }) => (5, number.cast_unsigned(), 0, &EMPTY),
            Some(Self::StackOverflow { sp }) => (6, *sp, 0, &EMPTY),
            Some(Self::Forgotten) => (7, 0, 0, &EMPTY),
        };
        let [a, b, c, d, e, f, g, h] = text.words();
        [kind, first, second, a, b, c, d, e, f, g, h]
    }

    /// `None` for words that are no fault, `Some(None)` for those of no fault.
    fn from_words(words: &[u32; FAULT]) -> Option<Option<Self>> {
        let &[kind, first, second, ref text @ ..] = words;
        let text = Text::from_words(text);
        Some(match kind {
            0 => None,
            1 => Some(Self::Stopped { why: text }),
            2 => Some(Self::Watchdog),
            3 => Some(Self::Panic {
                line: first,
                file: text,
            }),
            4 => Some(Self::HardFault {
                pc: first,
                lr: second,
            }),
            5 => Some(Self::Exception {
                number: first.cast_signed(),
            }),
            6 => Some(Self::StackOverflow { sp: first }),
            7 => Some(Self::Forgotten),
            _ => return None,
        })
    }
}

/// Words of the record: magic word, lot, starts, counters, fault, check of 64 bits.
pub const WORDS: usize = 3 + COUNTERS + FAULT + 2;

const COUNTERS: usize = Cause::ALL.len();

/// Begins every record; another layout gets another word.
const MAGIC: u32 = 0x7472_4E02;

/// What survives a reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Survivor {
    /// What the memory held by chance when power came.
    lot: u32,
    starts: u32,
    resets: [u32; COUNTERS],
    fault: Option<Fault>,
}

impl Survivor {
    /// Reads a record; `None` for memory that holds none, as after a loss of power.
    #[must_use]
    pub fn from_words(words: &[u32; WORDS]) -> Option<Self> {
        let [body @ .., low, high] = words;
        if [*low, *high] != check(body) {
            return None;
        }
        let [magic, lot, starts, rest @ ..] = body;
        let (resets, fault) = rest.split_first_chunk::<COUNTERS>()?;
        if *magic != MAGIC {
            return None;
        }
        Some(Self {
            lot: *lot,
            starts: *starts,
            resets: *resets,
            fault: Fault::from_words(fault.first_chunk()?)?,
        })
    }

    /// The record as it is stored.
    #[must_use]
    pub fn words(&self) -> [u32; WORDS] {
        let mut words = [0; WORDS];
        let body = [MAGIC, self.lot, self.starts]
            .into_iter()
            .chain(self.resets)
            .chain(Fault::words(self.fault.as_ref()));
        for (place, word) in words.iter_mut().zip(body) {
            *place = word;
        }
        let [body @ .., low, high] = &mut words;
        [*low, *high] = check(body);
        words
    }

    /// The record at a start for these causes, which is counted.
    ///
    /// Memory that holds none is as it must be where power came, and where no cause is known; else
    /// a fault may have been in it.
    #[must_use]
    pub fn at_start(words: &[u32; WORDS], causes: Causes) -> Self {
        let found = Self::from_words(words);
        let mut survivor = found.unwrap_or_else(|| Self {
            lot: check(words)[0],
            ..Self::default()
        });
        survivor.start(causes);
        if found.is_none() && causes.kept_power() {
            survivor.latch(Fault::Forgotten);
        }
        survivor
    }

    /// Counts a start; a watchdog among its causes is a fault.
    pub fn start(&mut self, causes: Causes) {
        self.starts = self.starts.saturating_add(1);
        if let Some(count) = self.resets.get_mut(causes.main() as usize) {
            *count = count.saturating_add(1);
        }
        if causes.contain_watchdog() {
            self.latch(Fault::Watchdog);
        }
    }

    /// Keeps a fault; the first one stays, because the others follow from it.
    pub fn latch(&mut self, fault: Fault) {
        self.fault.get_or_insert(fault);
    }

    /// A person has seen the fault.
    pub fn acknowledge(&mut self) {
        self.fault = None;
    }

    /// The fault that nobody has acknowledged yet.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Starts since power came.
    #[must_use]
    pub const fn starts(&self) -> u32 {
        self.starts
    }

    /// A number that is another one from start to start, over a loss of power too, after which the
    /// starts are counted anew.
    #[must_use]
    pub const fn number(&self) -> u16 {
        self.lot.wrapping_add(self.starts) as u16
    }

    /// Starts since power came that had this cause.
    #[must_use]
    pub const fn resets(&self, cause: Cause) -> u32 {
        self.resets[cause as usize]
    }
}

/// Check of the words of a record, low word first.
fn check(words: &[u32]) -> [u32; 2] {
    let mut hash = Hash::new();
    words.iter().for_each(|&word| hash.take_bits(word));
    let value = hash.value();
    [value as u32, (value >> 32) as u32]
}

#[cfg(test)]
mod tests;
