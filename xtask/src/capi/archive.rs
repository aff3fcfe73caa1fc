//! An archive: how it is built, and that nothing that it exports can panic.

use std::path::PathBuf;
use std::process::Command;

use object::{Object, ObjectSymbol};

use crate::process::{Done, M0, M3, M4F, cargo, run, target_directory};

/// A static library for one core.
#[derive(Clone, Copy)]
pub(crate) struct Archive {
    /// Target of rustc.
    pub target: &'static str,
    /// Profile of the workspace.
    pub profile: &'static str,
    /// What the table calls it.
    pub core: &'static str,
    /// Arguments of the compiler for this core; the last resort of what an archive of ours links
    /// with.
    pub machine: &'static [&'static str],
}

/// Target of a Cortex-M33 with floating-point unit.
pub(crate) const M33: &str = "thumbv8m.main-none-eabihf";
/// Target of this machine's kind.
pub(crate) const HOST: &str = "x86_64-unknown-linux-gnu";

const V7EM: &[&str] = &[
    "-mcpu=cortex-m4",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv4-sp-d16",
];

const fn fast(
    target: &'static str,
    core: &'static str,
    machine: &'static [&'static str],
) -> Archive {
    Archive {
        target,
        profile: "capi",
        core,
        machine,
    }
}

impl Archive {
    pub(crate) const M4F_FAST: Self = fast(M4F.target, "Cortex-M4F", V7EM);
    pub(crate) const M4F_SMALL: Self = Self::M4F_FAST.small();
    pub(crate) const HOST_FAST: Self = fast(HOST, "x86-64", &[]);

    /// Every core that a release is built for.
    pub(crate) const CORES: [Self; 6] = [
        fast(M0.target, "Cortex-M0, M0+", &["-mcpu=cortex-m0", "-mthumb"]),
        fast(M3.target, "Cortex-M3", &["-mcpu=cortex-m3", "-mthumb"]),
        Self::M4F_FAST,
        fast(
            "thumbv7em-none-eabi",
            "Cortex-M7, M4 with soft-float ABI",
            &["-mcpu=cortex-m4", "-mthumb"],
        ),
        fast(
            M33,
            "Cortex-M33",
            &[
                "-mcpu=cortex-m33",
                "-mthumb",
                "-mfloat-abi=hard",
                "-mfpu=fpv5-sp-d16",
            ],
        ),
        Self::HOST_FAST,
    ];

    /// The same with the smallest code.
    pub(crate) const fn small(self) -> Self {
        Self {
            profile: "capi-size",
            ..self
        }
    }

    /// Whether it is the one with the smallest code.
    pub(crate) fn is_small(self) -> bool {
        self.profile == "capi-size"
    }

    /// Features of the package: on a microcontroller without `trendid_any`, which has the code of
    /// every structure.
    fn features(self) -> &'static str {
        if self.machine.is_empty() {
            "archive,any"
        } else {
            "archive"
        }
    }

    /// Builds it.
    pub(crate) fn build(self) -> Done {
        run(cargo(&[
            "rustc",
            "-q",
            "-p",
            "trendid-capi",
            "--crate-type",
            "staticlib",
            "--no-default-features",
            "--features",
            self.features(),
            "--profile",
            self.profile,
            "--target",
            self.target,
        ]))
    }

    /// Where it lies.
    pub(crate) fn path(self) -> Result<PathBuf, String> {
        Ok(target_directory()?
            .join(self.target)
            .join(self.profile)
            .join("libtrendid_capi.a"))
    }

    /// Links these functions alone and gives the bytes of the image and the names in it.
    pub(crate) fn linked(self, functions: &[&str]) -> Result<(u64, Vec<String>), String> {
        let image = target_directory()?.join(format!("capi-linked-{}", std::process::id()));
        let compiler = if self.machine.is_empty() {
            "gcc"
        } else {
            "arm-none-eabi-gcc"
        };
        let mut command = Command::new(compiler);
        command.args(self.machine).args([
            "-nostdlib",
            "-Wl,--gc-sections",
            "-Wl,--no-warn-rwx-segments",
        ]);
        command.args(
            functions
                .iter()
                .map(|name| format!("-Wl,--undefined={name}")),
        );
        command.arg(format!(
            "-Wl,--entry={}",
            functions.first().ok_or("no function")?
        ));
        command.arg(self.path()?).arg("-o").arg(&image);
        // The memory functions of an operating system are in its shared library: the static one
        // wants a whole program.
        command.arg(if self.machine.is_empty() {
            "-lc"
        } else {
            "-static"
        });
        let output = command
            .output()
            .map_err(|error| format!("{compiler}: {error}"))?;
        if !output.status.success() {
            return Err(format!(
                "{} does not link: {}",
                functions.join(" "),
                String::from_utf8_lossy(&output.stderr)
            ));
        }
        let bytes = std::fs::read(&image).map_err(|error| error.to_string())?;
        let _ = std::fs::remove_file(&image);
        let file = object::File::parse(&*bytes).map_err(|error| error.to_string())?;
        let names = file
            .symbols()
            .filter_map(|symbol| symbol.name().ok().map(str::to_owned))
            .collect();
        Ok((code(&file), names))
    }

    /// Links every function of the header and looks for the machinery of panics; gives the number
    /// of functions.
    pub(crate) fn without_panics(self) -> Result<usize, String> {
        let functions = exported()?;
        let any = self.machine.is_empty();
        let names: Vec<_> = functions
            .iter()
            .map(String::as_str)
            .filter(|name| any || *name != "trendid_any_init")
            .collect();
        let (_, found) = self.linked(&names)?;
        if !names
            .iter()
            .all(|name| found.iter().any(|found| found == name))
        {
            return Err(
                "the image has not every function of the header: the search is broken".into(),
            );
        }
        if !found.iter().any(|name| is_panic(name)) {
            return Ok(names.len());
        }
        // Which ones.
        let mut faults = Vec::new();
        for name in &names {
            let (_, found) = self.linked(&[name])?;
            let panics: Vec<_> = found.into_iter().filter(|name| is_panic(name)).collect();
            if !panics.is_empty() {
                faults.push(format!("{name} reaches {}", panics.join(", ")));
            }
        }
        Err(format!(
            "{} ({}):\n{}",
            self.target,
            self.profile,
            faults.join("\n")
        ))
    }
}

/// Bytes of code and constants.
fn code(file: &object::File<'_>) -> u64 {
    use object::{ObjectSection, SectionKind};
    let kept = |kind| {
        matches!(
            kind,
            SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::Data
        )
    };
    let names = |name: &str| {
        !name.starts_with(".ARM.ex")
            && !name.starts_with(".eh_frame")
            && !name.starts_with(".gcc_except")
    };
    file.sections()
        .filter(|section| kept(section.kind()) && section.name().is_ok_and(names))
        .map(|section| section.size())
        .sum()
}

/// Whether a name belongs to the machinery of panics.
fn is_panic(name: &str) -> bool {
    name.contains("panic") || name.contains("rust_begin_unwind")
}

/// The functions of the header.
pub(crate) fn exported() -> Result<Vec<String>, String> {
    let path = crate::process::root().join("capi/include/trendid.h");
    let text =
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let code = || {
        text.lines()
            .filter(|line| !line.trim_start().starts_with("//"))
    };
    let mut names: Vec<_> = code()
        .flat_map(|line| line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '(')))
        .filter_map(|word| word.split_once('(').map(|(name, _)| name))
        .filter(|name| name.starts_with("trendid_"))
        .map(str::to_owned)
        .collect();
    names.sort();
    names.dedup();
    if names.is_empty() {
        Err("the header has no function".into())
    } else {
        Ok(names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_machinery_of_panics_is_known_by_its_names() {
        // As they stood in an image whose polynomial roots were found with checked indices.
        assert!(is_panic(
            "_ZN4core9panicking18panic_bounds_check17h0123456789abcdefE"
        ));
        assert!(is_panic("_RNvCs1_7___rustc17rust_begin_unwind"));
        assert!(!is_panic("trendid_servo3_init"));
    }

    #[test]
    fn the_functions_of_the_header_are_found() {
        let names = exported().unwrap();
        assert!(names.iter().any(|name| name == "trendid_identifier_update"));
        assert!(names.iter().all(|name| !name.ends_with("_t")));
        assert!(names.len() > 40, "{}", names.len());
    }
}
