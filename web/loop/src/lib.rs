//! The adaptive loop on a pneumatic axis: what the second part of the page calls.
//!
//! The exports take and give numbers; rows of f32 and texts lie in two buffers whose addresses
//! [`buffer`] and [`text`] give. A page is one thread, so the state lies in thread locals.

mod axis;

use std::cell::RefCell;

use axis::AxisPlay;

/// Numbers of the buffer.
const NUMBERS: usize = 1 << 16;

/// Bytes of the text.
const TEXT: usize = 256;

/// What the page plays with.
struct Play {
    numbers: Box<[f32; NUMBERS]>,
    text: [u8; TEXT],
    axis: Option<AxisPlay>,
}

thread_local! {
    static PLAY: RefCell<Play> = RefCell::new(Play {
        numbers: Box::new([0.0; NUMBERS]),
        text: [0; TEXT],
        axis: None,
    });
}

fn with<T>(act: impl FnOnce(&mut Play) -> T) -> T {
    PLAY.with_borrow_mut(act)
}

impl Play {
    /// Puts numbers into the buffer; how many found room.
    fn put(&mut self, values: &[f32]) -> u32 {
        let count = values.len().min(NUMBERS);
        self.numbers[..count].copy_from_slice(&values[..count]);
        count as u32
    }
}

/// Address of the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn buffer() -> *const f32 {
    with(|play| play.numbers.as_ptr())
}

/// Address of the text.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    with(|play| play.text.as_ptr())
}

/// Begins with the pneumatic axis: noise and resolution of its sensor \[um\], memory \[s\]; 1 when
/// the settings work.
#[unsafe(no_mangle)]
pub extern "C" fn loop_start(noise: f32, resolution: f32, memory: f32, seed: u32) -> u32 {
    with(|play| {
        play.axis = AxisPlay::new(noise, resolution, memory, seed);
        u32::from(play.axis.is_some())
    })
}

/// Asks the loop, in the numbers of `AxisPlay::ask`; the length of the refusal in the text, 0 when
/// it was done.
#[unsafe(no_mangle)]
pub extern "C" fn loop_ask(what: u32, a: f32, b: f32) -> u32 {
    with(|play| {
        let Some(axis) = &mut play.axis else { return 0 };
        match axis.ask(what, a, b) {
            Ok(()) => 0,
            Err(why) => say(&mut play.text, &why),
        }
    })
}

/// Samples of the loop; gives the number of rows t, r, y, u, innovation, state, reason, retuned.
#[unsafe(no_mangle)]
pub extern "C" fn loop_run(samples: u32) -> u32 {
    with(|play| {
        let Some(axis) = &mut play.axis else { return 0 };
        let rows: Vec<f32> = (0..samples.min(5000)).flat_map(|_| axis.step()).collect();
        play.put(&rows) / 8
    })
}

/// What the loop knows: a1, a2, b0 with standard deviations, the model in use (6), accepted,
/// refused; 0 before the first model.
#[unsafe(no_mangle)]
pub extern "C" fn loop_read() -> u32 {
    with(|play| {
        let Some(axis) = &play.axis else { return 0 };
        let read = axis.read();
        play.put(&read)
    })
}

/// The present state in words; gives their length.
#[unsafe(no_mangle)]
pub extern "C" fn loop_words() -> u32 {
    with(|play| {
        let Some(axis) = &play.axis else { return 0 };
        say(&mut play.text, &axis.words())
    })
}

/// Puts a text; gives its length.
fn say(text: &mut [u8; TEXT], words: &str) -> u32 {
    let count = words.len().min(TEXT);
    text[..count].copy_from_slice(&words.as_bytes()[..count]);
    count as u32
}
