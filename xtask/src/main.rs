//! Tasks of the project.
mod record;
fn main() { record::write(std::path::Path::new(".")).unwrap(); }
