use super::*;
use crate::random::Random;

const WATCHDOG: Causes = Causes::from_csr(0x2400_0000);
const SOFTWARE: Causes = Causes::from_csr(0x1400_0000);

fn faults() -> [Option<Fault>; 8] {
    [
        None,
        Some(Fault::Stopped {
            why: Text::end_of("three overruns in a row"),
        }),
        Some(Fault::Watchdog),
        Some(Fault::Panic {
            line: 321,
            file: Text::end_of("examples/servo/slot.rs"),
        }),
        Some(Fault::HardFault {
            pc: 0x0800_1234,
            lr: 0xFFFF_FFE9,
        }),
        Some(Fault::Exception { number: -4 }),
        Some(Fault::StackOverflow { sp: 0x1FFF_FFF8 }),
        Some(Fault::Forgotten),
    ]
}

fn survivor(fault: Option<Fault>) -> Survivor {
    let mut survivor = Survivor::default();
    survivor.start(Causes::from_csr(0x0E00_0000));
    survivor.start(SOFTWARE);
    survivor.fault = fault;
    survivor
}

#[test]
fn every_record_comes_back() {
    for fault in faults() {
        let survivor = survivor(fault);
        assert_eq!(Survivor::from_words(&survivor.words()), Some(survivor));
        assert_eq!(survivor.starts(), 2);
        assert_eq!(survivor.resets(Cause::PowerOn), 1);
        assert_eq!(survivor.resets(Cause::Software), 1);
        assert_eq!(survivor.resets(Cause::Pin), 0);
    }
}

#[test]
fn a_wrong_bit_anywhere_is_no_record() {
    for fault in faults() {
        let good = survivor(fault).words();
        for word in 0..WORDS {
            for bit in 0..32 {
                let mut bad = good;
                bad[word] ^= 1 << bit;
                assert_eq!(Survivor::from_words(&bad), None, "word {word}, bit {bit}");
            }
        }
    }
}

#[test]
fn memory_after_power_on_is_no_record() {
    for word in [0, u32::MAX, 0xA5A5_A5A5, MAGIC] {
        assert_eq!(Survivor::from_words(&[word; WORDS]), None);
    }
    // A write that was cut off: the front of one record and the end of the other.
    let [old, new] = [survivor(None).words(), survivor(faults()[3]).words()];
    for cut in 0..=WORDS {
        let mixed = core::array::from_fn(|i| if i < cut { new[i] } else { old[i] });
        let whole = mixed == old || mixed == new;
        assert_eq!(
            Survivor::from_words(&mixed).is_some(),
            whole,
            "cut at {cut}"
        );
    }
}

#[test]
fn another_layout_or_kind_is_no_record() {
    for (place, word) in [(0, MAGIC + 1), (3 + COUNTERS, 8)] {
        let mut words = survivor(None).words();
        words[place] = word;
        let [body @ .., low, high] = &mut words;
        [*low, *high] = check(body);
        assert_eq!(Survivor::from_words(&words), None, "word {place}");
    }
}

#[test]
fn a_watchdog_stays_a_fault_until_it_is_acknowledged() {
    let mut survivor = Survivor::default();
    survivor.start(WATCHDOG);
    survivor.start(SOFTWARE);
    assert_eq!(survivor.fault(), Some(Fault::Watchdog));
    survivor.acknowledge();
    survivor.start(SOFTWARE);
    assert_eq!(survivor.fault(), None);
    assert_eq!(survivor.resets(Cause::IndependentWatchdog), 1);
}

#[test]
fn a_record_that_is_damaged_while_power_is_there_is_a_fault() {
    let latched = survivor(Some(Fault::HardFault { pc: 1, lr: 2 })).words();
    let mut damaged = latched;
    damaged[5] ^= 1 << 9;
    let fault = |words, csr| Survivor::at_start(&words, Causes::from_csr(csr)).fault();
    for csr in [0x0400_0000, 0x1400_0000, 0x4400_0000, 0x8400_0000] {
        let kept = Some(Fault::HardFault { pc: 1, lr: 2 });
        assert_eq!(fault(latched, csr), kept);
    }
    for csr in [0x0400_0000, 0x1400_0000, 0x8400_0000] {
        assert_eq!(fault(damaged, csr), Some(Fault::Forgotten), "{csr:x}");
    }
    // A watchdog says more.
    assert_eq!(fault(damaged, 0x2400_0000), Some(Fault::Watchdog));
    // Power came, after which memory holds anything; and the emulator.
    for csr in [0x0E00_0000, 0x0600_0000, 0x1E00_0000, 0] {
        assert_eq!(fault(damaged, csr), None, "{csr:x}");
    }
    let again = Survivor::at_start(&damaged, SOFTWARE);
    assert_eq!((again.starts(), again.resets(Cause::Software)), (1, 1));
}

#[test]
fn no_start_has_the_number_of_the_one_before() {
    let mut dice = Random::new(5);
    let (mut words, mut before, mut alike) = ([0; WORDS], None, 0);
    for start in 0..3000 {
        let away = dice.bits() >> 30 == 0;
        if away {
            // Most cells come up as ever, some by chance.
            words = core::array::from_fn(|place| {
                let noise = (0..4).fold(u32::MAX, |noise, _| noise & dice.bits());
                (place as u32).wrapping_mul(0x9E37_79B9) ^ noise
            });
        }
        let causes = if away { 0x0E00_0000 } else { 0x1400_0000 };
        let survivor = Survivor::at_start(&words, Causes::from_csr(causes));
        words = survivor.words();
        let number = Some(survivor.number());
        assert!(away || number != before, "start {start}");
        alike += u32::from(number == before);
        before = number;
    }
    assert!(alike < 3, "{alike} of some 750 losses of power");
}

#[test]
fn the_first_fault_is_kept() {
    let first = Fault::HardFault { pc: 1, lr: 2 };
    let mut survivor = Survivor::default();
    survivor.latch(first);
    survivor.start(WATCHDOG);
    assert_eq!(survivor.fault(), Some(first));
}

#[test]
fn counters_stand_at_their_end() {
    let mut survivor = Survivor {
        starts: u32::MAX,
        resets: [u32::MAX; COUNTERS],
        ..Survivor::default()
    };
    survivor.start(SOFTWARE);
    assert_eq!(survivor.starts(), u32::MAX);
    assert_eq!(survivor.resets(Cause::Software), u32::MAX);
}

#[test]
fn of_a_long_text_the_end_is_kept() {
    assert_eq!(Text::end_of("").as_str(), "");
    assert_eq!(Text::end_of("src/lib.rs").as_str(), "src/lib.rs");
    let text = "registry/src/index/stm32f4xx-hal-0.23.0/src/watchdog.rs";
    assert_eq!(
        Text::end_of(text).as_str(),
        "2f4xx-hal-0.23.0/src/watchdog.rs"
    );
    // 33 bytes, of which the first two are one character.
    assert_eq!(
        Text::end_of("\u{b5}0123456789012345678901234567890").as_str(),
        "0123456789012345678901234567890"
    );
}
