//! Short texts on the wire.

/// A short text: what does not fit is cut.
pub type Text = heapless::String<40>;

/// As much of a text as fits.
#[must_use]
pub fn text(words: &str) -> Text {
    let mut text = Text::new();
    for letter in words.chars() {
        if text.push(letter).is_err() {
            break;
        }
    }
    text
}
