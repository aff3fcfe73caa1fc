//! Which mutants an error of the compiler comes from.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use serde_json::Value;

use crate::switch::Switched;

/// The mutants in whose text an error stands: by the place of the error, or else by those that it
/// mentions.
pub(crate) fn blame(message: &Value, texts: &BTreeMap<String, Switched>) -> BTreeSet<u32> {
    let mut spans: Vec<(bool, &str, Range<usize>)> = Vec::new();
    for span in message["spans"].as_array().into_iter().flatten() {
        let number = |key: &str| span[key].as_u64().map(|n| n as usize);
        if let (Some(file), Some(begin), Some(end)) = (
            span["file_name"].as_str(),
            number("byte_start"),
            number("byte_end"),
        ) {
            spans.push((span["is_primary"] == true, file, begin..end));
        }
    }
    for primary in [true, false] {
        let mut found = BTreeSet::new();
        for (_, file, range) in spans.iter().filter(|span| span.0 == primary) {
            let places = texts.get(*file).map_or(&[][..], |text| &text.places);
            let within =
                |place: &Range<usize>| place.start <= range.start && range.end <= place.end;
            found.extend(places.iter().filter(|(_, p)| within(p)).map(|(n, _)| *n));
        }
        if !found.is_empty() {
            return found;
        }
    }
    // A match that needs the arm: its error is at what is matched, in front of the arm.
    let arms = spans
        .iter()
        .filter(|span| span.0)
        .filter_map(|(_, file, range)| {
            let text = texts.get(*file)?;
            let arm =
                |place: &Range<usize>| text.text[place.clone()].starts_with("if !crate::switched");
            let behind = text
                .places
                .iter()
                .filter(|(_, place)| place.start >= range.end && arm(place));
            behind
                .min_by_key(|(_, place)| place.start)
                .map(|(number, _)| *number)
        });
    match message["code"]["code"] == "E0004" {
        true => arms.collect(),
        false => BTreeSet::new(),
    }
}
