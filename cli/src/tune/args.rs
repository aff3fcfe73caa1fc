//! What a loop of `trendid tune` is asked for.

use std::path::PathBuf;

use clap::Args;
use trendid_identify::Choice;

/// What a loop is asked for.
#[derive(Debug, Args)]
pub(super) struct LoopArgs {
    /// Bandwidth in rad/s, up to half a radian per sample, or the largest robust one
    #[arg(long, value_name = "W|auto", default_value = "auto", value_parser = parse_bandwidth, allow_negative_numbers = true)]
    pub(super) bandwidth: Choice<f64>,
    /// Write pictures of the step and of the open loop (SVG) into this directory
    #[arg(long, value_name = "DIR")]
    pub(super) plot: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// `--bandwidth W|auto` for clap.
fn parse_bandwidth(text: &str) -> Result<Choice<f64>, String> {
    match (text, text.parse::<f64>()) {
        ("auto", _) => Ok(Choice::Auto),
        (_, Ok(bandwidth)) if bandwidth > 0.0 && bandwidth.is_finite() => {
            Ok(Choice::Given(bandwidth))
        }
        _ => Err("expected a number of rad/s above 0, or `auto`".into()),
    }
}
