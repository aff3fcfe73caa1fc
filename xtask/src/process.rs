//! Other programs: cargo, the emulator.

use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

/// What a task ends with: nothing, or a sentence for the user.
pub(crate) type Done = Result<(), String>;

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    let mut path = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    path.pop();
    path
}

/// A cargo command in the root.
///
/// RUSTFLAGS would replace the linker arguments of `.cargo/config.toml` and give an empty image, so
/// it is taken away.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .current_dir(root())
        .args(arguments)
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    command
}

/// Runs a command with its output on the terminal.
pub(crate) fn run(mut command: Command) -> Done {
    eprintln!("$ {}", shown(&command));
    let status = command
        .status()
        .map_err(|error| format!("{}: {error}", shown(&command)))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{} ended with {status}", shown(&command)))
    }
}

/// Whether a command can be started and succeeds; its output is dropped.
pub(crate) fn works(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// The command line for messages, without the path of cargo itself.
fn shown(command: &Command) -> String {
    let program = command.get_program().to_string_lossy();
    let program = program.rsplit('/').next().unwrap_or_default();
    let arguments = command
        .get_args()
        .map(|argument| argument.to_string_lossy().into_owned());
    as_typed([program.to_owned()].into_iter().chain(arguments))
}

/// Words as one types them: those that a shell would take apart in quotes.
pub(crate) fn as_typed<W: AsRef<str>>(words: impl IntoIterator<Item = W>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quoted = |word: &str| match word {
        _ if !word.is_empty() && word.chars().all(plain) => word.to_owned(),
        // Within these a shell looks for nothing but these.
        _ if !word.contains(['"', '$', '`', '\\', '!']) => format!("\"{word}\""),
        _ => format!("'{}'", word.replace('\'', "'\\''")),
    };
    let words: Vec<_> = words.into_iter().map(|w| quoted(w.as_ref())).collect();
    words.join(" ")
}

/// Where cargo puts what it builds.
pub(crate) fn target_directory() -> Result<PathBuf, String> {
    let output = cargo(&["metadata", "--format-version", "1", "--no-deps"])
        .output()
        .map_err(|error| format!("cargo metadata: {error}"))?;
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("cargo metadata: {error}"))?;
    metadata["target_directory"]
        .as_str()
        .map(PathBuf::from)
        .ok_or_else(|| "cargo metadata names no target directory".to_owned())
}

/// An emulated board.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Machine {
    /// Name in QEMU.
    pub name: &'static str,
    /// Target of rustc.
    pub target: &'static str,
}

/// STM32F405, Cortex-M4F.
pub(crate) const M4F: Machine = Machine {
    name: "netduinoplus2",
    target: "thumbv7em-none-eabihf",
};
/// ARM MPS2, Cortex-M3.
pub(crate) const M3: Machine = Machine {
    name: "mps2-an385",
    target: "thumbv7m-none-eabi",
};
/// BBC micro:bit, Cortex-M0.
pub(crate) const M0: Machine = Machine {
    name: "microbit",
    target: "thumbv6m-none-eabi",
};

impl Machine {
    /// Builds an example of the core for this machine and gives the path of its image.
    pub(crate) fn build(self, example: &str, profile: &str) -> Result<PathBuf, String> {
        self.build_of("trendid", example, profile)
    }

    /// As [`build`](Self::build), of another package.
    pub(crate) fn build_of(
        self,
        package: &str,
        example: &str,
        profile: &str,
    ) -> Result<PathBuf, String> {
        let arguments = [
            "build",
            "-q",
            "-p",
            package,
            "--no-default-features",
            "--profile",
            profile,
            "--target",
            self.target,
            "--example",
            example,
        ];
        run(cargo(&arguments))?;
        let directory = if profile == "dev" { "debug" } else { profile };
        Ok(target_directory()?
            .join(self.target)
            .join(directory)
            .join("examples")
            .join(example))
    }

    /// Starts an image and hands it a word; one instruction is one nanosecond of its clock, and
    /// waiting takes no time.
    pub(crate) fn start(self, image: &std::path::Path, word: &str) -> Result<Child, String> {
        self.launch(image, word, "null", Stdio::null())
    }

    /// Starts an image with its first serial line on `serial`.
    fn launch(
        self,
        image: &std::path::Path,
        word: &str,
        serial: &str,
        input: Stdio,
    ) -> Result<Child, String> {
        let semihosting = format!("enable=on,target=native,arg=image,arg={word}");
        Command::new("qemu-system-arm")
            .args([
                "-machine",
                self.name,
                "-nographic",
                "-monitor",
                "none",
                "-serial",
                serial,
            ])
            .args([
                "-semihosting-config",
                &semihosting,
                "-icount",
                "shift=0,sleep=off",
                "-kernel",
            ])
            .arg(image)
            .stdin(input)
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| {
                format!("qemu-system-arm does not start ({error}); run `cargo xtask setup`")
            })
    }

    /// Runs an image to its end and gives its output; an error when it fails or needs longer than
    /// `limit`.
    pub(crate) fn output(
        self,
        image: &std::path::Path,
        word: &str,
        limit: Duration,
    ) -> Result<Vec<u8>, String> {
        self.finish(self.start(image, word)?, Vec::new(), image, limit)
    }

    /// As [`output`](Self::output), with `said` on the first serial line, once the image has
    /// written a line: what it receives before it listens is lost. What comes back over the line is
    /// in the output.
    pub(crate) fn talk(
        self,
        image: &std::path::Path,
        said: Vec<u8>,
        limit: Duration,
    ) -> Result<Vec<u8>, String> {
        let child = self.launch(image, "run", "stdio", Stdio::piped())?;
        self.finish(child, said, image, limit)
    }

    /// Waits for the end of an image, to whose first line `said` is the answer.
    fn finish(
        self,
        mut child: Child,
        said: Vec<u8>,
        image: &std::path::Path,
        limit: Duration,
    ) -> Result<Vec<u8>, String> {
        let mut stdout = child.stdout.take().ok_or("no output of the emulator")?;
        let mut input = child.stdin.take();
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || {
            let mut output = Vec::new();
            if let Some(input) = &mut input {
                let mut byte = [0];
                while byte != *b"\n" && stdout.read_exact(&mut byte).is_ok() {
                    output.push(byte[0]);
                }
                // An image that ended hears nothing.
                let _ = input.write_all(&said).and_then(|()| input.flush());
            }
            let _ = stdout.read_to_end(&mut output);
            // The receiver is gone after the time limit.
            let _ = sender.send(output);
        });
        let Ok(output) = receiver.recv_timeout(limit) else {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("{} did not end within {limit:?}", image.display()));
        };
        let status = child.wait().map_err(|error| error.to_string())?;
        if status.success() {
            Ok(output)
        } else {
            let text = String::from_utf8_lossy(&output);
            Err(format!(
                "{} on {} ended with {status}:\n{text}",
                image.display(),
                self.name
            ))
        }
    }

    /// As [`output`](Self::output), as lines of text.
    pub(crate) fn lines(
        self,
        image: &std::path::Path,
        limit: Duration,
    ) -> Result<Vec<String>, String> {
        let output = self.output(image, "", limit)?;
        Ok(String::from_utf8_lossy(&output)
            .lines()
            .map(str::to_owned)
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::as_typed;

    #[test]
    fn a_command_that_is_shown_can_be_typed() {
        let words = ["--only", "a day's mixture", "it's $5", "x=/a_b.c", ""];
        let shown = as_typed(words);
        assert_eq!(
            shown,
            r#"--only "a day's mixture" 'it'\''s $5' x=/a_b.c """#
        );
        let typed = std::process::Command::new("sh")
            .args(["-c", &format!("printf '%s\n' {shown}")])
            .output();
        // Where there is a shell.
        if let Ok(typed) = typed {
            assert_eq!(
                String::from_utf8_lossy(&typed.stdout),
                words.map(|word| format!("{word}\n")).concat()
            );
        }
    }
}
