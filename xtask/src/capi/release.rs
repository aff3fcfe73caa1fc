//! What a user without Rust gets: header, archives of every core, the configuration of CMake, and a
//! table of sizes.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::capi::archive::Archive;
use crate::capi::tools;
use crate::process::{Done, root, target_directory};
use crate::setup;

/// What a program has that uses one part, and the functions that it calls.
const PARTS: [(&str, &[&str]); 4] = [
    (
        "servo3",
        &[
            "trendid_servo3_init",
            "trendid_identifier_update",
            "trendid_identifier_theta",
            "trendid_identifier_estimate",
        ],
    ),
    (
        "valve3",
        &[
            "trendid_valve3_init",
            "trendid_identifier_update",
            "trendid_identifier_theta",
            "trendid_identifier_estimate",
        ],
    ),
    (
        "loop",
        &[
            "trendid_loop_init",
            "trendid_loop_commission",
            "trendid_loop_update",
            "trendid_loop_move_to",
        ],
    ),
    (
        "loop, store, load",
        &[
            "trendid_loop_init",
            "trendid_loop_commission",
            "trendid_loop_update",
            "trendid_loop_move_to",
            "trendid_loop_store",
            "trendid_loop_load",
        ],
    ),
];

/// Builds all archives into target/capi-release; gives the table.
pub(crate) fn run() -> Result<String, String> {
    tools::all()?;
    setup::add_targets(&Archive::CORES.map(|archive| archive.target))?;
    let all: Vec<_> = Archive::CORES
        .iter()
        .flat_map(|core| [*core, core.small()])
        .collect();
    for archive in &all {
        archive.build()?;
    }
    let place = target_directory()?.join("capi-release");
    stage(&place, &all)?;
    let mut table = String::from("| core | -O | archive [kB] |");
    for (part, _) in PARTS {
        let _ = write!(table, " {part} [B] |");
    }
    table += "\n|---|---|---|";
    table += &"---|".repeat(PARTS.len());
    table += "\n";
    for archive in &all {
        let bytes = fs::metadata(archive.path()?)
            .map_err(|error| error.to_string())?
            .len();
        let opt = if archive.is_small() { "s" } else { "3" };
        let _ = write!(table, "| {} | {opt} | {} |", archive.core, bytes / 1000);
        for (_, functions) in PARTS {
            let (code, _) = archive.linked(functions)?;
            let _ = write!(table, " {code} |");
        }
        table += "\n";
    }
    fs::write(place.join("SIZES.md"), &table).map_err(|error| error.to_string())?;
    Ok(table)
}

/// A tree as `find_package` wants it, with these archives.
pub(crate) fn stage(place: &Path, archives: &[Archive]) -> Done {
    let fail = |error: std::io::Error| format!("{}: {error}", place.display());
    let _ = fs::remove_dir_all(place);
    let copy = |from: &Path, to: &Path| {
        fs::create_dir_all(to.parent().unwrap_or(place))?;
        fs::copy(from, to).map(|_| ())
    };
    let capi = root().join("capi");
    for header in ["trendid.h", "trendid.hpp"] {
        copy(
            &capi.join("include").join(header),
            &place.join("include").join(header),
        )
        .map_err(fail)?;
    }
    for file in ["trendid-config.cmake", "trendid-target.cmake"] {
        copy(
            &capi.join("cmake").join(file),
            &place.join("lib/cmake/trendid").join(file),
        )
        .map_err(fail)?;
    }
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        copy(&root().join(licence), &place.join(licence)).map_err(fail)?;
    }
    for archive in archives {
        let variant = if archive.is_small() { "small" } else { "fast" };
        let to = place
            .join("lib")
            .join(archive.target)
            .join(variant)
            .join("libtrendid.a");
        copy(&archive.path()?, &to).map_err(fail)?;
    }
    Ok(())
}
