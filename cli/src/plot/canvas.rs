//! Where is drawn, and lengths on it.

use plotters::coord::Shift;
use plotters::prelude::*;

/// Everything is drawn this much larger, because coordinates are whole pixels; the header of the
/// file scales it down.
const SCALE: u32 = 3;

/// A length in pixels of the finished picture.
pub(crate) fn px(length: u32) -> u32 {
    length * SCALE
}

/// The font at a size in pixels of the finished picture.
pub(crate) fn font(size: u32) -> (&'static str, u32) {
    ("sans-serif", px(size))
}

/// Where is drawn.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Result of drawing.
pub(crate) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
