//! Arithmetic below everything else; the only file that names libm.
//!
//! The identifier calls no function of libm for a sample: on a Cortex-M4F they are software, and
//! several go through soft doubles. The position loop does in few: see
//! [`ServoLoop`](crate::servo::ServoLoop).

pub(crate) mod complex;
pub(crate) mod matrix;
pub(crate) mod polynomial;
pub(crate) mod roots;
pub(crate) mod sum;

/// Square root, 0 for arguments below 0 (a variance that rounding made negative).
pub(crate) fn sqrt(x: f32) -> f32 {
    if x > 0.0 { libm::sqrtf(x) } else { 0.0 }
}

/// Standard deviation of a variance; infinite where rounding or overflow left no variance
/// (negative, NaN).
pub(crate) fn deviation(variance: f32) -> f32 {
    if variance >= 0.0 {
        sqrt(variance)
    } else {
        f32::INFINITY
    }
}

/// `value` to a whole power of any size, by squaring. Cost: 5 instructions for each digit of the
/// power.
pub(crate) const fn power(value: f32, mut power: u32) -> f32 {
    let (mut square, mut product) = (value, 1.0);
    while power > 0 {
        if power % 2 == 1 {
            product *= square;
        }
        square *= square;
        power /= 2;
    }
    product
}

/// `value` to a whole power as small as an order, rounded at every product.
pub(crate) fn raised(value: f32, power: usize) -> f32 {
    let mut product = 1.0;
    for _ in 0..power {
        product *= value;
    }
    product
}

/// `x` to the power `y`, for `x >= 0`.
pub(crate) fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Sine of an angle in radians.
pub(crate) fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// The larger of two numbers; the second where one is NaN. Without the call that `f32::max` is on a
/// Cortex-M4.
#[inline]
pub(crate) const fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, in the same way.
#[inline]
pub(crate) const fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The sign of a value; 0 of zero and NaN.
#[inline(always)]
pub(crate) fn sign(value: f32) -> f32 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
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
