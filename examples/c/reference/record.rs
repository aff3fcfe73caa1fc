//! The record in text.

/// What ends a run.
pub(crate) type Error = Box<dyn std::error::Error>;

/// Command and position of the record in text.
pub(crate) fn table() -> Result<Vec<(f32, f32)>, Error> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data/servo.csv");
    let text = std::fs::read_to_string(path)?;
    let mut rows = Vec::new();
    for line in text.lines().skip(6) {
        let mut fields = line.split(',').skip(1).map(str::parse::<f32>);
        match (fields.next(), fields.next()) {
            (Some(u), Some(y)) => rows.push((u?, y?)),
            _ => return Err(format!("{path}: {line}").into()),
        }
    }
    Ok(rows)
}
