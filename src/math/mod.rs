//! The only file that names libm and micromath.
//!
//! Nothing here is called in the 1 ms path: on a Cortex-M4F these functions are
//! software, and several go through soft doubles.

pub(crate) mod polynomial;

/// Square root, 0 for arguments below 0 (a variance that rounding made negative).
pub(crate) fn sqrt(x: f32) -> f32 {
    if x > 0.0 { libm::sqrtf(x) } else { 0.0 }
}

/// `x` to the power `y`, for `x >= 0`.
pub(crate) fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Sine of an angle in radians.
pub(crate) fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// `value` within `-bound..=bound`; no panic path, unlike `f32::clamp`. NaN passes.
#[inline(always)]
pub(crate) fn within(value: f32, bound: f32) -> f32 {
    if value > bound {
        bound
    } else if value < -bound {
        -bound
    } else {
        value
    }
}

/// Approximations for telemetry and displays; a few percent, never the estimator.
///
/// # Examples
/// ```
/// let level = trendid::approximate::decibel(100.0);
/// assert!((level - 40.0).abs() < 1.0);
/// ```
#[cfg(feature = "approximate")]
pub mod approximate {
    // Named in each call: where std is linked, its methods would be taken instead.
    use micromath::F32Ext;

    /// Amplitude ratio in dB, 20 log10 of the magnitude, to about 1 dB.
    pub fn decibel(ratio: f32) -> f32 {
        20.0 * F32Ext::log10(ratio.abs())
    }

    /// Square root to a few percent, for a bar on a display.
    pub fn sqrt(x: f32) -> f32 {
        F32Ext::sqrt(x)
    }
}
