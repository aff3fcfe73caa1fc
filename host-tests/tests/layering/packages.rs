//! The sources of every package and program.

use std::path::Path;

/// Folders of the root package and of the tests; those of the other packages are found.
///
/// In those that contain programs, each folder with a `main.rs` or `lib.rs` is one.
const FOLDERS: [&str; 3] = ["src", "examples", "host-tests/tests"];

/// The sources below a folder, by their path from it.
pub(crate) fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        let entries =
            std::fs::read_dir(&next).unwrap_or_else(|e| panic!("{}: {e}", next.display()));
        for path in entries.map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|x| x == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source");
                let name = path.strip_prefix(folder).expect("below").to_string_lossy();
                files.push((name.replace('\\', "/"), text));
            }
        }
    }
    files
}

/// The folders below `at` that hold a package; none of them is a package of another workspace or of
/// a build.
fn package_folders(root: &Path, at: &str, found: &mut Vec<String>) {
    let entries = std::fs::read_dir(root.join(at)).expect("a folder");
    for entry in entries.map(|entry| entry.expect("an entry")) {
        let name = entry.file_name().to_string_lossy().into_owned();
        let skipped = name.starts_with('.') || ["target", "src", "examples"].contains(&&*name);
        if skipped || !entry.path().is_dir() {
            continue;
        }
        let folder = if at.is_empty() {
            name
        } else {
            format!("{at}/{name}")
        };
        if entry.path().join("Cargo.toml").exists() && entry.path().join("src").exists() {
            found.push(format!("{folder}/src"));
            package_folders(root, &folder, found);
        }
    }
}

/// Each package and program.
pub(crate) fn packages() -> Vec<(String, Vec<(String, String)>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut folders: Vec<String> = FOLDERS.map(String::from).to_vec();
    package_folders(&root, "", &mut folders);
    let mut found = Vec::new();
    for package in &folders {
        let files = sources(&root.join(package));
        let programs = files.iter().filter_map(|(file, _)| {
            file.strip_suffix("/main.rs")
                .or(file.strip_suffix("/lib.rs"))
        });
        for program in programs {
            let own = files.iter().filter_map(|(file, text)| {
                let file = file.strip_prefix(program)?.strip_prefix('/')?;
                Some((file.to_owned(), text.clone()))
            });
            found.push((format!("{package}/{program}"), own.collect()));
        }
        let is_root = |(file, _): &(String, String)| ["lib.rs", "main.rs"].contains(&file.as_str());
        if files.iter().any(is_root) {
            found.push((package.clone(), files));
        }
    }
    found
}
