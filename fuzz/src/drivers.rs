//! What buses and timers answer to the drivers.

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use embedded_hal::spi::{self, Operation, SpiDevice};
use trendid::hardware::{
    DacValve, PositionSensor, PwmValve, SsiCode, SsiEncoder, SsiFormat, Valve,
};

use crate::bytes::Bytes;

/// What failed on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Broken;

impl spi::Error for Broken {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl pwm::Error for Broken {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

/// A bus that answers these bytes, and keeps what was written.
#[derive(Debug, Default)]
struct Bus {
    answer: [u8; 4],
    fails: bool,
    written: Vec<u8>,
}

impl spi::ErrorType for &mut Bus {
    type Error = Broken;
}

impl SpiDevice for &mut Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Broken> {
        if self.fails {
            return Err(Broken);
        }
        for operation in operations {
            match operation {
                Operation::Read(bytes) => bytes
                    .iter_mut()
                    .zip(self.answer)
                    .for_each(|(place, byte)| *place = byte),
                Operation::Write(bytes) => self.written.extend_from_slice(bytes),
                other => panic!("{other:?}"),
            }
        }
        Ok(())
    }
}

/// Pulse and direction, as the bridge of the valve sees them.
#[derive(Debug, Default)]
struct Bridge {
    max: u16,
    duty: u16,
    forward: Option<bool>,
    /// Calls until one fails; none when zero.
    until: u8,
    /// What the pulse means now: its sign, where there is one.
    wanted: f32,
}

impl Bridge {
    fn call(&mut self) -> Result<(), Broken> {
        if self.until == 0 {
            return Ok(());
        }
        self.until -= 1;
        if self.until == 0 { Err(Broken) } else { Ok(()) }
    }

    /// No pulse ever has the wrong sign: not even between the calls of one command.
    fn look(&self) {
        if self.duty > 0 {
            let forward = self.forward.expect("a pulse without a direction");
            let old = self.wanted;
            assert!(
                old == 0.0 || (old > 0.0) == forward,
                "a pulse against the command {old}"
            );
        }
    }
}

struct Pulse<'a>(&'a std::cell::RefCell<Bridge>);
struct Direction<'a>(&'a std::cell::RefCell<Bridge>);

impl pwm::ErrorType for Pulse<'_> {
    type Error = Broken;
}

impl SetDutyCycle for Pulse<'_> {
    fn max_duty_cycle(&self) -> u16 {
        self.0.borrow().max
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        let mut bridge = self.0.borrow_mut();
        bridge.call()?;
        assert!(duty <= bridge.max, "{duty} of {}", bridge.max);
        bridge.duty = duty;
        if duty > 0 {
            bridge.look();
        }
        Ok(())
    }
}

impl digital::ErrorType for Direction<'_> {
    type Error = Broken;
}

impl OutputPin for Direction<'_> {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.set(false)
    }

    fn set_high(&mut self) -> Result<(), Broken> {
        self.set(true)
    }
}

impl Direction<'_> {
    fn set(&mut self, forward: bool) -> Result<(), Broken> {
        let mut bridge = self.0.borrow_mut();
        bridge.call()?;
        assert!(
            bridge.duty == 0 || bridge.forward == Some(forward),
            "the direction changes under a pulse"
        );
        bridge.forward = Some(forward);
        Ok(())
    }
}

/// Runs what the bytes say.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    match bytes.choice(3) {
        0 => encoder(bytes),
        1 => converter(bytes),
        _ => bridge(bytes),
    }
}

fn encoder(mut bytes: Bytes<'_>) {
    let options = bytes.byte();
    let format = SsiFormat {
        bits: bytes.choice(40),
        code: if options & 1 == 0 {
            SsiCode::Gray
        } else {
            SsiCode::Binary
        },
        alarm: options & 2 != 0,
        parity: options & 4 != 0,
    };
    while !bytes.is_empty() {
        let mut bus = Bus {
            fails: bytes.byte() == 0,
            answer: bytes.take(),
            ..Bus::default()
        };
        let (fails, answer) = (bus.fails, bus.answer);
        let dead = answer[0] < 0x80 || answer == [0xFF; 4];
        let Some(mut encoder) = SsiEncoder::new(&mut bus, format) else {
            assert!(!(1..=29).contains(&format.bits));
            return;
        };
        match encoder.counts() {
            Ok(counts) => {
                assert!((0..1_i64 << format.bits).contains(&i64::from(counts)));
                assert!(!fails && !dead);
                // The same number from the bits one by one, in the order in which they arrive.
                let bit = |k: u8| answer[usize::from(k / 8)] >> (7 - k % 8) & 1;
                let mut found = 0;
                for k in 1..=format.bits {
                    let before = match format.code {
                        SsiCode::Gray => found as u8 & 1,
                        _ => 0,
                    };
                    found = (found << 1) | i32::from(bit(k) ^ before);
                }
                assert_eq!(counts, found);
            }
            Err(_) => assert!(fails || dead || format.alarm || format.parity),
        }
    }
}

fn converter(mut bytes: Bytes<'_>) {
    while !bytes.is_empty() {
        let command = bytes.signal(1.5);
        let mut bus = Bus {
            fails: bytes.byte() == 0,
            ..Bus::default()
        };
        let set = DacValve::new(&mut bus).drive(command);
        let Ok(set) = set else {
            assert!(bus.fails);
            continue;
        };
        let wanted = if command.is_nan() {
            0.0
        } else {
            command.clamp(-1.0, 1.0)
        };
        assert!(
            (set - wanted).abs() <= 0.51 / 32_767.0,
            "{set} for {wanted}"
        );
        let [0, high, low] = bus.written[..] else {
            panic!("{:?}", bus.written)
        };
        let code = i32::from(u16::from_be_bytes([high, low])) - 0x8000;
        assert_eq!(code as f32 / 32_767.0, set);
    }
}

fn bridge(mut bytes: Bytes<'_>) {
    let bridge = std::cell::RefCell::new(Bridge {
        max: u16::from_le_bytes(bytes.take()),
        ..Bridge::default()
    });
    let mut valve = PwmValve::new(Pulse(&bridge), Direction(&bridge));
    while !bytes.is_empty() {
        let command = bytes.signal(1.5);
        let wanted = if command.is_nan() {
            0.0
        } else {
            command.clamp(-1.0, 1.0)
        };
        {
            let mut bridge = bridge.borrow_mut();
            bridge.until = bytes.choice(8);
            bridge.wanted = wanted;
        }
        let set = valve.drive(command);
        let mut now = bridge.borrow_mut();
        now.until = 0;
        if let Ok(set) = set {
            assert!((-1.0..=1.0).contains(&set));
            let full = f32::from(now.max);
            if now.max > 0 {
                assert!((set - wanted).abs() <= 0.51 / full, "{set} for {wanted}");
                assert_eq!(f32::from(now.duty) / full, set.abs());
            } else {
                assert_eq!((set, now.duty), (0.0, 0));
            }
        }
        drop(now);
        let safe = valve.safe().is_ok();
        let now = bridge.borrow();
        assert!(safe && now.duty == 0, "the safe output is no pulse");
    }
}
