//! Only what is small is `Copy`: every public type of the core that is, with its size.

use std::collections::BTreeSet;
use std::mem::size_of;
use std::path::Path;

use trendid::error::{ConfigError, Setting};
use trendid::estimation::{NoiseLevel, Parameter, Structure, Terms};
use trendid::hardware::{Axis, PwmError, Scale, SsiCode, SsiError, SsiFormat};
use trendid::identifier::{Outcome, Refusal};
use trendid::inputs::{Coulomb, DeadZone};
use trendid::instruments::Way;
use trendid::model::{Physical, Pole, PredictionError, TransferFunction};
use trendid::servo::store::{Identity, Refused, StoreError};
use trendid::servo::{
    Error, FaultCounters, FitReport, Margins, Model, Motion, MotionLimits, Reason, Setpoint, State,
    Travel,
};
use trendid::trends::{Chain, Form, Hold, Mapped, Scheme, Trends, Window};

/// What an interrupt may copy without a thought for its stack, in bytes.
const SMALL: usize = 64;

/// The sizes of types by their name, on this machine: words are as long as on the target or longer.
macro_rules! sizes {
    ($($name:ident $(<$($shape:tt),*>)?),* $(,)?) => {
        [$((stringify!($name), size_of::<$name $(<$($shape),*>)?>())),*]
    };
}

/// The names in the sources: `pub struct` or `pub enum` below a `derive` with `Copy`.
fn copied(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).expect("the sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            copied(&path, found);
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a source");
        let mut copy = false;
        for line in text.lines() {
            if let Some(list) = line.strip_prefix("#[derive(") {
                copy = list.contains("Copy");
            }
            let item = line
                .strip_prefix("pub struct ")
                .or(line.strip_prefix("pub enum "));
            if let (Some(item), true) = (item, copy) {
                let end = item.find(|c: char| !c.is_alphanumeric());
                found.insert(item[..end.unwrap_or(item.len())].to_owned());
            }
            // Attributes and comments stand between the two.
            copy &= line.starts_with("#[") || line.starts_with("//");
        }
    }
}

#[test]
fn what_is_copied_is_small() {
    let sizes = sizes![
        Axis,
        Chain<4>,
        ConfigError,
        Coulomb,
        DeadZone,
        Error,
        FaultCounters,
        FitReport,
        Form,
        Hold,
        Identity,
        Mapped<4>,
        Margins,
        Model,
        Motion,
        MotionLimits,
        NoiseLevel,
        Outcome,
        Parameter,
        Physical<4>,
        Pole,
        PredictionError,
        PwmError<u32, u32>,
        Reason,
        Refusal,
        Refused,
        Scale,
        Scheme,
        Setpoint,
        Setting,
        SsiCode,
        SsiError<u32>,
        SsiFormat,
        State,
        StoreError<u32>,
        Structure<4, 9, 2>,
        Terms,
        TransferFunction<4, 2>,
        Travel,
        Trends<4>,
        Way,
        Window<4>,
    ];
    for (name, size) in sizes {
        println!("{name}: {size} bytes");
        assert!(size <= SMALL, "{name} has {size} bytes");
    }
    let mut found = BTreeSet::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    copied(&root, &mut found);
    let listed: BTreeSet<String> = sizes.iter().map(|(name, _)| name.to_string()).collect();
    assert_eq!(found, listed);
}
