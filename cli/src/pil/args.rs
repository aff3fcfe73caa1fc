//! Arguments of `trendid pil`.

use std::path::PathBuf;

use trendid_host_tests::servo::scenario::Scenario;

#[derive(clap::Args)]
#[command(after_help = "Examples:
  cargo xtask pil                      builds the image and runs it in the emulator
  trendid pil --scenario mass
  trendid pil --samples 2000 --faults 20 --failures 300
  trendid pil --port /dev/ttyUSB0      a board with the image (not tried on hardware)

The scenarios are those of `trendid demo`. The axis is simulated here and has the command of the target; the loop
runs on the target and once more here, and after every sample all that both computed must be the same bits.")]
pub(crate) struct PilArgs {
    /// Change or fault of the axis, see `trendid demo`
    #[arg(
        long,
        value_name = "NAME",
        default_value = "nominal",
        hide_possible_values = true,
        value_parser = Scenario::ALL.map(Scenario::name)
    )]
    pub(super) scenario: String,
    /// The gains stay as the commissioning found them
    #[arg(long)]
    pub(super) fixed: bool,
    /// Image for the emulator, built by `cargo xtask pil`
    #[arg(
        long,
        default_value = "target/thumbv7em-none-eabihf/firmware/examples/pil"
    )]
    pub(super) image: PathBuf,
    /// Serial port of a board that runs the image, instead of the emulator
    #[arg(long, conflicts_with = "image")]
    pub(super) port: Option<String>,
    /// Ends the run after so many samples of 1 ms; without, the whole scenario runs
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) samples: Option<u32>,
    /// Disturbs one frame in N in each direction: a wrong bit, a lost byte, a lost frame, a frame
    /// that comes twice
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) faults: Option<u32>,
    /// Every Nth reading of the sensor fails
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub(super) failures: Option<u32>,
    /// Seed of the axis and of the faults
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Prints the result as JSON
    #[arg(long)]
    pub(super) json: bool,
}
