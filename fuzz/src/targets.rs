//! The list of the targets.

use crate::{drivers, identifier, link, record, servo_loop, store};

/// A target: takes any bytes, and panics where something does not hold.
pub type Target = fn(&[u8]);

/// Every target, under the name of its program and of its corpus.
pub const TARGETS: [(&str, Target); 6] = [
    ("identifier", identifier::run),
    ("servo_loop", servo_loop::run),
    ("link", link::run),
    ("store", store::run),
    ("record", record::run),
    ("drivers", drivers::run),
];
