//! Settings as words: each number at every value that makes no sense, and what a refusal tells.

use core::ffi::CStr;
use core::mem::MaybeUninit;

use trendid_capi as c;

/// A number of a settings struct, one of its words of four bytes.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Type {
    Float,
    Int,
    Unsigned,
}

/// Name, type and count of the fields of a struct, in its order.
pub(crate) type Fields = [(&'static str, Type, usize)];

/// Name, place in its list (-1 for a single value) and type of every word.
pub(crate) fn words(fields: &Fields) -> Vec<(&'static str, i32, Type)> {
    let of = |&(name, kind, count): &(&'static str, Type, usize)| {
        (0..count as i32).map(move |k| (name, if count == 1 { -1 } else { k }, kind))
    };
    fields.iter().flat_map(of).collect()
}

/// Replaces a word of a struct of C that has nothing but words.
pub(crate) fn set_word<T: Copy>(of: &mut T, word: usize, bits: u32) {
    assert!(4 * word < size_of::<T>() && align_of::<T>() == 4);
    // SAFETY: within the struct and aligned; every value of a word is one of its field.
    unsafe { (&raw mut *of).cast::<u32>().add(word).write(bits) };
}

/// Values that a word is set to: as bits, and as what a detail calls them.
pub(crate) fn values(kind: Type) -> Vec<(u32, f32)> {
    let floats = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -1.0,
        0.0,
        1.0,
        1e-30,
        1e30,
    ];
    let ints = [0, 1, 2, 3, -1, -2, 1 << 20, i32::MAX, i32::MIN];
    match kind {
        Type::Float => floats.map(|value| (value.to_bits(), value)).to_vec(),
        Type::Int => ints.map(|value| (value as u32, value as f32)).to_vec(),
        Type::Unsigned => ints
            .map(|value| (value as u32, value as u32 as f32))
            .to_vec(),
    }
}

pub(crate) fn no_detail() -> c::Detail {
    // SAFETY: zeros are a detail: numbers, and the error 0.
    unsafe { MaybeUninit::zeroed().assume_init() }
}

/// The name of the setting that was refused.
pub(crate) fn name(detail: &c::Detail) -> String {
    let letters = detail.setting.map(|letter| letter as u8);
    let text = CStr::from_bytes_until_nul(&letters).expect("a name ends");
    text.to_string_lossy().into_owned()
}

/// Whether a detail says that this value is none.
pub(crate) fn tells(detail: &c::Detail, value: f32) -> bool {
    let given = detail.value.to_bits() == value.to_bits() || detail.value == value;
    let beyond = match detail.error {
        c::Error::NotFinite => !value.is_finite(),
        c::Error::NotPositive => !(value > 0.0 && value.is_finite()),
        // An infinite limit allows every finite value.
        c::Error::OutOfRange => !(value >= detail.low && value <= detail.high && value.is_finite()),
        _ => false,
    };
    given && beyond
}
