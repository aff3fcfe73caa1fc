//! The playground: what a static page calls.
//!
//! The exports take and give numbers; rows of f32 lie in a buffer whose address [`buffer`] gives. A
//! page is one thread, so the state lies in thread locals.
//!
//! | export | what |
//! |---|---|
//! | `servo_*` | the servo of the paper, identified sample by sample |
//! | `speed_*` | the time of 1e5 samples |

mod servo;
mod speed;

use std::cell::RefCell;

use servo::ServoPlay;

/// Numbers of the buffer.
const NUMBERS: usize = 1 << 16;

/// What the page plays with.
struct Play {
    numbers: Box<[f32; NUMBERS]>,
    servo: Option<ServoPlay>,
    speed: Vec<[f32; 2]>,
}

thread_local! {
    static PLAY: RefCell<Play> = RefCell::new(Play {
        numbers: Box::new([0.0; NUMBERS]),
        servo: None,
        speed: Vec::new(),
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

/// Begins with the servo of the paper: widths of the noise, the drift and the resolution \[um\],
/// bandwidth of the filter \[rad/s\], memory \[s\] (0: nothing is forgotten); 1 when the settings
/// work.
#[unsafe(no_mangle)]
pub extern "C" fn servo_start(
    eta: f32,
    drift: f32,
    eps: f32,
    filter: f32,
    memory: f32,
    seed: u32,
) -> u32 {
    with(|play| {
        play.servo = ServoPlay::new([eta, drift, eps], filter, memory, seed).ok();
        u32::from(play.servo.is_some())
    })
}

/// Samples of the servo; gives the number of rows t, u, y, x.
#[unsafe(no_mangle)]
pub extern "C" fn servo_run(samples: u32) -> u32 {
    with(|play| {
        let Some(servo) = &mut play.servo else {
            return 0;
        };
        let rows: Vec<f32> = (0..samples.min(10_000))
            .flat_map(|_| servo.step())
            .collect();
        play.put(&rows) / 4
    })
}

/// What is known of the servo: six numbers (a1, a2, b0, C, omega0, xi), their standard deviations,
/// those of the bound.
#[unsafe(no_mangle)]
pub extern "C" fn servo_read() -> u32 {
    with(|play| {
        let Some(servo) = &play.servo else { return 0 };
        let read = servo.read();
        play.put(&read)
    })
}

/// Prepares a record for the measurement of speed.
#[unsafe(no_mangle)]
pub extern "C" fn speed_fill(samples: u32) {
    with(|play| play.speed = speed::record(samples.min(1_000_000)));
}

/// Identifies it; gives a1.
#[unsafe(no_mangle)]
pub extern "C" fn speed_run() -> f32 {
    with(|play| speed::identify(&play.speed))
}
