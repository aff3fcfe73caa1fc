//! A file for a record before the machine is known: what cannot be written is said at the start.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::PathBuf;

/// A file for a record of a machine that is not known yet.
pub(crate) struct Claimed {
    pub(crate) path: PathBuf,
    pub(crate) file: File,
}

impl Claimed {
    /// Makes the file; one that is there is not overwritten.
    pub(crate) fn create(path: PathBuf) -> Result<Self, String> {
        let named = |error: std::io::Error| match error.kind() {
            ErrorKind::AlreadyExists => {
                format!(
                    "{}: it is there already, and is not overwritten",
                    path.display()
                )
            }
            _ => format!("{}: {error}", path.display()),
        };
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(named)?;
        }
        let file = File::create_new(&path).map_err(named)?;
        Ok(Self { path, file })
    }

    /// Takes the file away again, without a machine; says which one.
    pub(crate) fn give_up(self) -> String {
        // Nothing is in it: one that stays is no record.
        let _ = fs::remove_file(&self.path);
        format!("{}: nothing was recorded", self.path.display())
    }
}
