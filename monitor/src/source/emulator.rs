//! The firmware of the servo example in QEMU, in real time, on its simulated drive.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::args::Args;
use crate::source::call::{File, Place, Port};
use crate::source::channel::{Line, Said};
use crate::source::gdb::{Gdb, carry};
use crate::source::line::{again, pump};

/// Target of the image.
const TARGET: &str = "thumbv7em-none-eabihf";

/// Pause before it is looked again whether the emulator has called.
const PAUSE: Duration = Duration::from_millis(20);

/// The emulator; it ends with this.
struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub(super) fn run(args: &Args, mut line: Line) {
    let image = match &args.image {
        Some(image) => image.clone(),
        None => {
            line.say(Said::Down("builds the image for the emulator".into()));
            match build() {
                Ok(image) => image,
                Err(why) => return line.say(Said::Down(why)),
            }
        }
    };
    let name = image.file_name().unwrap_or_default().to_string_lossy();
    let name = format!("{name} in QEMU");
    again(&mut line, |line| {
        if args.rtt {
            let (stream, _emulator) = Start::rtt(&image).at(Port::new(), line)?;
            return carry(Gdb::new(stream)?, &name, line);
        }
        let (stream, _emulator) = Start::wire(&image).at(File::new(), line)?;
        line.say(Said::Up(name.clone()));
        pump(stream, line)
    });
}

/// Builds the image from the sources that this program was built from; gives its path.
fn build() -> Result<PathBuf, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let output = Command::new("cargo")
        .current_dir(&root)
        // It would replace the linker arguments and give an empty image.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .args(["build", "-p", "trendid", "--no-default-features"])
        .args(["--profile", "firmware", "--target", TARGET])
        .args(["--example", "servo"])
        .args(["--message-format", "json-render-diagnostics"])
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err(
            "the image was not built: `cargo xtask setup` adds its target, --image names one"
                .into(),
        );
    }
    executable(&String::from_utf8_lossy(&output.stdout))
        .ok_or_else(|| "cargo names no image: --image names one".into())
}

/// The executable that cargo's messages name.
fn executable(messages: &str) -> Option<PathBuf> {
    let named = |line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        message["executable"].as_str().map(PathBuf::from)
    };
    messages.lines().filter_map(named).next_back()
}

/// What the emulator is started with.
struct Start<'a> {
    image: &'a Path,
    /// What the image is told.
    word: &'static str,
    serial: &'static str,
    stub: &'static str,
}

impl<'a> Start<'a> {
    /// Telemetry over the serial line.
    fn wire(image: &'a Path) -> Self {
        Self {
            image,
            word: "wire",
            serial: "chardev:line",
            stub: "none",
        }
    }

    /// Telemetry over RTT, which a debugger's stub reads.
    fn rtt(image: &'a Path) -> Self {
        Self {
            image,
            word: "rtt",
            serial: "null",
            stub: "chardev:line",
        }
    }

    /// Starts QEMU, which calls back before the first instruction.
    fn at<P: Place>(
        &self,
        place: std::io::Result<P>,
        line: &Line,
    ) -> Result<(P::Stream, Emulator), String> {
        let failed = |error: std::io::Error| format!("a socket for QEMU: {error}");
        let place = place.map_err(failed)?;
        let mut emulator = self.spawn(&place.option().map_err(failed)?)?;
        loop {
            match place.answer() {
                Ok(stream) => return Ok((stream, emulator)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => return Err(failed(error)),
            }
            match emulator.0.try_wait() {
                Ok(None) if line.lives() => thread::sleep(PAUSE),
                Ok(None) => return Err("the program ends".into()),
                Ok(Some(status)) => return Err(format!("QEMU has ended: {status}")),
                Err(error) => return Err(format!("QEMU: {error}")),
            }
        }
    }

    fn spawn(&self, socket: &str) -> Result<Emulator, String> {
        Command::new("qemu-system-arm")
            .args(["-machine", "netduinoplus2", "-nographic"])
            .args(["-monitor", "none"])
            // Its script leaves the requests to the line.
            .arg("-semihosting-config")
            .arg(format!("enable=on,target=native,arg=image,arg={}", self.word))
            .args(["-chardev", &format!("socket,id=line,{socket}")])
            .args(["-serial", self.serial, "-gdb", self.stub, "-kernel"])
            .arg(self.image)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .map(Emulator)
            .map_err(|error| {
                format!(
                    "qemu-system-arm does not start ({error}): `cargo xtask setup` says what to install"
                )
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_what_cargo_says() {
        let messages = concat!(
            "{\"reason\":\"compiler-artifact\",\"executable\":null}\n",
            "{\"reason\":\"compiler-artifact\",\"executable\":\"/t/servo\"}\n",
            "{\"reason\":\"build-finished\",\"success\":true}\n",
        );
        assert_eq!(executable(messages), Some(PathBuf::from("/t/servo")));
        assert_eq!(executable("{}\nnot json"), None);
    }
}
