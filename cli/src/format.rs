//! Numbers and transfer functions as an engineer writes them.

/// `value` with `digits` significant digits: plain between 1e-3 and 1e6, with
/// an exponent outside.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    // Rounding first decides the exponent: 9.996 with three digits is 10.0.
    let rounded = format!("{value:.*e}", digits - 1);
    let exponent: i32 = rounded
        .split_once('e')
        .map_or(0, |(_, e)| e.parse().unwrap_or(0));
    if (-3..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        rounded
    }
}

/// `value +- sigma`, the deviation with two significant digits and the value
/// to the same decimal place.
pub(crate) fn with_sigma(value: f64, sigma: f64) -> String {
    if !(sigma.is_finite() && sigma > 0.0 && value.is_finite()) {
        return format!("{} +- ?", significant(value, 4));
    }
    let exponent = |x: f64| x.abs().log10().floor() as i32;
    let last = exponent(sigma) - 1;
    let lead = if value == 0.0 {
        last
    } else {
        exponent(value).max(exponent(sigma))
    };
    if (-4..6).contains(&lead) && last > -10 {
        let decimals = (-last).max(0) as usize;
        format!("{value:.decimals$} +- {sigma:.decimals$}")
    } else {
        let scale = 10f64.powi(lead);
        let decimals = (lead - last).clamp(0, 12) as usize;
        format!(
            "({:.decimals$} +- {:.decimals$})e{lead}",
            value / scale,
            sigma / scale
        )
    }
}

/// `1 zero`, `2 zeros`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

/// A relative error in percent, with its sign.
pub(crate) fn percent(estimate: f64, truth: f64) -> String {
    if truth == 0.0 {
        return "-".into();
    }
    format!("{:+.3} %", 100.0 * (estimate - truth) / truth)
}

/// A polynomial in `s` from ascending coefficients, highest power first; exact
/// zeros are absent terms.
pub(crate) fn polynomial(ascending: &[f64]) -> String {
    let mut text = String::new();
    for (i, &c) in ascending
        .iter()
        .enumerate()
        .rev()
        .filter(|(_, c)| **c != 0.0)
    {
        let power = match i {
            0 => String::new(),
            1 => "s".into(),
            _ => format!("s^{i}"),
        };
        text += match (text.is_empty(), c < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        match (c.abs() == 1.0, power.is_empty()) {
            (true, false) => text += &power,
            (_, true) => text += &significant(c.abs(), 4),
            (false, false) => text += &format!("{} {power}", significant(c.abs(), 4)),
        }
    }
    if text.is_empty() { "0".into() } else { text }
}

/// `B(s) / A(s)`, with the factor `e^(-tau s)` when there is a dead time in s.
/// `b` and `a` are ascending, `a` without its leading one.
pub(crate) fn transfer_function(b: &[f64], a: &[f64], delay_s: f64) -> String {
    let mut denominator = a.to_vec();
    denominator.push(1.0);
    let bracket = |p: String| {
        if p.trim_start_matches('-').contains(' ') {
            format!("({p})")
        } else {
            p
        }
    };
    // A single coefficient needs no brackets although it may carry a sign.
    let numerator = if b.len() == 1 {
        polynomial(b)
    } else {
        bracket(polynomial(b))
    };
    let mut text = format!("{numerator} / {}", bracket(polynomial(&denominator)));
    if delay_s > 0.0 {
        text += &format!(" * e^(-{} s)", significant(delay_s, 3));
    }
    text
}

/// Lines of cells, every column as wide as its widest cell; the first column
/// flush left, the others flush right.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| {
        rows.iter()
            .filter_map(|r| r.get(c))
            .map(|s| s.chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::from(" ");
        for (c, cell) in row.iter().enumerate() {
            let w = widths[c];
            line += &if c == 0 {
                format!(" {cell:<w$}")
            } else {
                format!("   {cell:>w$}")
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_survive_rounding_up() {
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(0.0123456, 3), "0.0123");
        assert_eq!(significant(1.0e6, 3), "1.00e6");
        assert_eq!(significant(999_999.9, 4), "1.000e6");
        assert_eq!(significant(400.0, 4), "400.0");
        assert_eq!(significant(-2.5e-5, 2), "-2.5e-5");
        assert_eq!(significant(0.0, 4), "0");
        assert_eq!(significant(f64::NAN, 4), "NaN");
    }

    #[test]
    fn the_deviation_decides_the_digits() {
        assert_eq!(with_sigma(2.14037, 0.0123), "2.140 +- 0.012");
        assert_eq!(with_sigma(0.0, 0.5), "0.00 +- 0.50");
        assert_eq!(with_sigma(402.31, 14.2), "402 +- 14");
        assert_eq!(with_sigma(1.0003e6, 400.0), "(1.00030 +- 0.00040)e6");
        assert_eq!(with_sigma(1.0, f64::NAN), "1.000 +- ?");
    }

    #[test]
    fn transfer_functions_are_in_the_usual_notation() {
        assert_eq!(
            transfer_function(&[1.0e6], &[0.0, 400.0, 20.0], 0.0),
            "1.000e6 / (s^3 + 20.00 s^2 + 400.0 s)"
        );
        assert_eq!(
            transfer_function(&[2.0, -1.0], &[0.0], 0.16),
            "(-s + 2.000) / s * e^(-0.160 s)"
        );
        assert_eq!(
            transfer_function(&[-0.5], &[-3.0], 0.0),
            "-0.5000 / (s - 3.000)"
        );
        assert_eq!(polynomial(&[0.0, 0.0]), "0");
    }

    #[test]
    fn columns_line_up() {
        let rows = [
            vec!["a".into(), "10".into()],
            vec!["long".into(), "1".into()],
        ];
        assert_eq!(table(&rows), "  a      10\n  long    1\n");
    }
}
