//! Values of arguments.

use trendid_identify::Choice;
use trendid_identify::dynamic::DELAY;

use crate::output::Refusal;

/// `y^3` is the column y and the exponent 3.
pub(super) fn power(name: &str) -> Result<(&str, i32), Refusal> {
    let Some((column, exponent)) = name.rsplit_once('^') else {
        return Ok((name, 1));
    };
    match exponent.parse() {
        Ok(e @ 1..=9) => Ok((column, e)),
        _ => Err(Refusal::new(format!(
            "the power in `{name}` is not a digit from 1 to 9"
        ))),
    }
}

/// `--dead-zone WIDTH|auto` for clap.
pub(super) fn width(text: &str) -> Result<Choice<f64>, String> {
    match (text, text.parse::<f64>()) {
        ("auto", _) => Ok(Choice::Auto),
        (_, Ok(width)) if width >= 0.0 && width.is_finite() => Ok(Choice::Given(width)),
        _ => Err("expected a number of 0 or more, or `auto`".into()),
    }
}

/// `--filter POLE|auto|none` for clap; a pole may be given as printed, with its minus sign.
pub(crate) fn filter(text: &str) -> Result<Choice<Option<f64>>, String> {
    match text {
        "auto" => Ok(Choice::Auto),
        "none" => Ok(Choice::Given(None)),
        _ => match text.parse::<f64>() {
            Ok(pole) if pole != 0.0 && pole.is_finite() => Ok(Choice::Given(Some(pole.abs()))),
            _ => Err("expected a number of rad/s other than 0, `auto` or `none`".into()),
        },
    }
}

/// `--dt S` for clap.
pub(super) fn interval(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(dt) if dt > 0.0 && dt.is_finite() => Ok(dt),
        _ => Err("expected a number of seconds above 0".into()),
    }
}

/// `--order M` and `--zeros K` for clap; which of these numbers there are the structure says.
pub(super) fn whole(least: u8, most: u8) -> impl Fn(&str) -> Result<usize, String> + Clone {
    move |text| {
        let number = text.parse();
        number.map_err(|_| format!("expected a whole number from {least} to {most}"))
    }
}

/// `--delay D|auto` for clap.
pub(crate) fn delay(text: &str) -> Result<Choice<usize>, String> {
    match (text, text.parse::<usize>()) {
        ("auto", _) => Ok(Choice::Auto),
        (_, Ok(delay)) if delay <= DELAY => Ok(Choice::Given(delay)),
        _ => Err(format!(
            "expected a number of samples from 0 to {DELAY}, or `auto`"
        )),
    }
}
