//! The frames of defmt as text, for the images of this project.
//!
//! Wire format 4: a frame is rzCOBS-encoded and ends with zero. It holds the address of its format string in the section
//! `.defmt` (two bytes, low first) and the arguments in order, little endian. `defmt-print` and probe-rs understand all of
//! defmt; here are the argument types that the firmware examples use, so that nothing has to be installed.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use object::{Object, ObjectSymbol};

/// The format strings of an image.
pub struct Table(BTreeMap<u64, (String, String)>);

impl Table {
    /// Reads the strings from the symbols of an image.
    pub fn read(path: &Path) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let file =
            object::File::parse(&*bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut strings = BTreeMap::new();
        for symbol in file.symbols() {
            // The name of such a symbol is a JSON object with the kind of the string and the string.
            let Ok(name) = symbol.name() else { continue };
            let Ok(json) = serde_json::from_str::<serde_json::Value>(name) else {
                continue;
            };
            if let (Some(tag), Some(data)) = (json["tag"].as_str(), json["data"].as_str()) {
                strings.insert(symbol.address(), (tag.to_owned(), data.to_owned()));
            }
        }
        Ok(Self(strings))
    }

    /// The lines of a stream of frames.
    pub fn lines(&self, stream: &[u8]) -> Result<Vec<String>, String> {
        stream
            .split(|&byte| byte == 0)
            .filter(|frame| !frame.is_empty())
            .map(|frame| self.line(frame))
            .collect()
    }

    fn line(&self, frame: &[u8]) -> Result<String, String> {
        let bytes = unstuffed(frame).ok_or("a frame of defmt is cut off")?;
        let mut bytes = bytes.as_slice();
        let address = u64::from(u16::from_le_bytes(take(&mut bytes)?));
        let (tag, format) = self
            .0
            .get(&address)
            .ok_or_else(|| format!("no format string at {address}"))?;
        let level = tag.trim_start_matches("defmt_").to_uppercase();
        Ok(format!("{level:5} {}", self.text(format, &mut bytes)?))
    }

    fn text(&self, format: &str, bytes: &mut &[u8]) -> Result<String, String> {
        let mut text = String::new();
        let mut rest = format;
        while let Some(open) = rest.find('{') {
            text += &rest[..open];
            let close = rest[open..]
                .find('}')
                .ok_or("a format string without end")?
                + open;
            let done = match &rest[open + 1..close] {
                "=u8" => write!(text, "{}", take::<1>(bytes)?[0]),
                "=bool" => write!(text, "{}", take::<1>(bytes)?[0] != 0),
                "=u16" => write!(text, "{}", u16::from_le_bytes(take(bytes)?)),
                "=u32" => write!(text, "{}", u32::from_le_bytes(take(bytes)?)),
                "=i32" => write!(text, "{}", i32::from_le_bytes(take(bytes)?)),
                "=f32" => write!(text, "{:.4}", f32::from_le_bytes(take(bytes)?)),
                "=str" => {
                    let length = u32::from_le_bytes(take(bytes)?) as usize;
                    let (string, after) = bytes
                        .split_at_checked(length)
                        .ok_or("a string is cut off")?;
                    *bytes = after;
                    write!(text, "{}", String::from_utf8_lossy(string))
                }
                other => {
                    return Err(format!(
                        "argument {{{other}}}: this decoder does not know it, use defmt-print"
                    ));
                }
            };
            done.map_err(|error| error.to_string())?;
            rest = &rest[close + 1..];
        }
        Ok(text + rest)
    }
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Result<[u8; N], String> {
    let (first, rest) = bytes.split_first_chunk().ok_or("an argument is cut off")?;
    *bytes = rest;
    Ok(*first)
}

/// Undoes rzCOBS: read from the end, a byte below 128 says which of the seven bytes before it are zero, a byte from 128 on
/// that a zero and 7 to 133 other bytes come, and 255 that 134 bytes come without a zero.
fn unstuffed(frame: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut rest = frame.iter().rev();
    while let Some(&code) = rest.next() {
        match code {
            0 => return None,
            1..=0x7F => {
                for bit in (0..7).rev() {
                    bytes.push(if code >> bit & 1 == 1 {
                        0
                    } else {
                        *rest.next()?
                    });
                }
            }
            0x80..=0xFE => {
                bytes.push(0);
                for _ in 0..usize::from(code & 0x7F) + 7 {
                    bytes.push(*rest.next()?);
                }
            }
            0xFF => {
                for _ in 0..134 {
                    bytes.push(*rest.next()?);
                }
            }
        }
    }
    bytes.reverse();
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_decoded() {
        let string = "x {=f32} {=str} {=u32}!".to_owned();
        let table = Table([(3, ("defmt_info".to_owned(), string))].into());
        // 3 as u16, 1.5f32, "ab", 1u32: 03 00 | 00 00 C0 3F | 02 00 00 00 61 62 | 01 00 00 00, then zeros to full groups.
        let body = [
            3, 0, 0, 0, 0xC0, 0x3F, 2, 0, 0, 0, 0x61, 0x62, 1, 0, 0, 0, 0, 0, 0, 0, 0,
        ];
        let mut frame = Vec::new();
        for group in body.chunks(7) {
            let mut code = 0;
            for (bit, byte) in group.iter().enumerate() {
                if *byte == 0 {
                    code |= 1 << bit;
                } else {
                    frame.push(*byte);
                }
            }
            frame.push(code);
        }
        frame.push(0);
        assert_eq!(
            table.lines(&frame),
            Ok(vec!["INFO  x 1.5000 ab 1!".to_owned()])
        );
        assert!(table.lines(&[5, 1, 0]).is_err(), "cut off");
    }

    #[test]
    fn long_runs_are_decoded() {
        let run: Vec<u8> = (0..20).map(|k| 100 + k).collect();
        let frame = [&run[..], &[0x80 + 13]].concat();
        assert_eq!(
            unstuffed(&frame),
            Some([&run[..], &[0]].concat()),
            "20 bytes and the zero that follows"
        );
    }
}
