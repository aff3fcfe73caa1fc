//! What the fuzzer has found, and bytes by chance, on every target: with every other test, without
//! a fuzzer.

use std::path::Path;

use trendid_fuzz::{TARGETS, Target};

/// Inputs by chance for each target; `cargo xtask fuzz` runs many millions that are not by chance.
const INPUTS: u32 = 300;

/// Every file of a corpus; how many.
fn corpus(name: &str, target: Target) -> usize {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(name);
    let files = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut count = 0;
    for file in files {
        let path = file.expect("a file").path();
        println!("{name} {path:?}");
        target(&std::fs::read(&path).expect("bytes"));
        count += 1;
    }
    count
}

/// Inputs of growing length by a generator of 64 bits (Steele and others, SplitMix64, 2014).
fn by_chance(target: Target) {
    let mut state = 1_u64;
    for number in 0..INPUTS {
        let bytes: Vec<u8> = (0..number % 97 * 3)
            .map(|_| {
                state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
                let mixed = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
                (mixed >> 56) as u8
            })
            .collect();
        target(&bytes);
    }
}

macro_rules! targets {
    ($($name:ident),+) => {$(
        #[test]
        fn $name() {
            let target = TARGETS.iter().find(|(name, _)| *name == stringify!($name)).expect("a target").1;
            assert!(corpus(stringify!($name), target) > 0, "no corpus");
            by_chance(target);
        }
    )+};
}

targets!(identifier, servo_loop, link, store, record, drivers);
