//! The one picture of Table 1: errors over the noise level, for paper, opponents, bound and core.

use std::path::{Path, PathBuf};

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use trendid_host_tests::paper::statistics::Line;
use trendid_host_tests::paper::trial::Method;
use trendid_host_tests::signals::noise::Reading;

use crate::paper::args::Table1Args;
use crate::plot::{Area, COLOURS, Drawing, Drawn, GREY, font, px, save as save_drawing};

/// One line of the picture: a name and its errors of C, omega0, xi at each noise level \[%\].
struct Series {
    name: &'static str,
    colour: RGBColor,
    points: Vec<(f64, [f64; 3])>,
}

/// Three panels with logarithmic axes side by side.
struct Picture {
    title: String,
    series: Vec<Series>,
}

/// Writes `DIR/table1.svg` from the block white in RELATIVE, else in ABSOLUTE.
pub(super) fn save(dir: &Path, args: &Table1Args, lines: &[Line]) -> Result<PathBuf, String> {
    let white = |reading| -> Vec<&Line> {
        lines
            .iter()
            .filter(|l| l.setting.vary == "white" && l.setting.condition.reading == reading)
            .collect()
    };
    let mut chosen = white(Reading::Relative);
    if chosen.is_empty() {
        chosen = white(Reading::Absolute);
    }
    let Some(first) = chosen.first() else {
        return Err("no line of the block white to draw".to_owned());
    };
    let of = |name, colour, method: Method, errors: fn(&Line) -> [f64; 3]| Series {
        name,
        colour,
        points: chosen
            .iter()
            .filter(|l| l.method == method)
            // The paper's scale in both readings: the levels are the same four.
            .map(|l| (l.setting.condition.ns_pct, errors(l)))
            .collect(),
    };
    let ours = Method::DEFAULT;
    let picture = Picture {
        title: format!(
            "rms error [%] over noise to signal [%]: white noise, {}, {} s, {} records per level",
            first.setting.reading().to_uppercase(),
            first.duration_s,
            args.seeds
        ),
        series: vec![
            of(
                "paper, Tustin, as printed",
                COLOURS[1],
                ours,
                Line::paper_pct,
            ),
            of("extended Kalman filter", COLOURS[3], Method::Kalman, |l| {
                l.rms_pct
            }),
            of("trendid, default", COLOURS[0], ours, |l| l.rms_pct),
            of(
                "offline output-error fit",
                COLOURS[2],
                Method::OutputError,
                |l| l.rms_pct,
            ),
            of("Cramer-Rao bound", GREY, ours, |l| l.bound_pct),
        ],
    };
    save_drawing(&picture, dir, "table1")
}

/// Decades that hold all values.
fn decades(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return (0.1, 10.0);
    }
    (
        10f64.powf(low.log10().floor()),
        10f64.powf(high.log10().ceil()),
    )
}

impl Drawing for Picture {
    fn size(&self) -> (u32, u32) {
        (1000, 420)
    }

    fn draw(&self, area: &Area) -> Drawn {
        area.fill(&WHITE)?;
        let area = area.margin(px(8), 0, 0, 0).titled(&self.title, font(17))?;
        let (panels, legend) = area.split_vertically(px(340));
        let all = || self.series.iter().flat_map(|s| &s.points);
        // The same ordinate everywhere, so that panels compare.
        let (low, high) = decades(all().flat_map(|(_, e)| *e));
        for (i, panel) in panels.split_evenly((1, 3)).iter().enumerate() {
            let name = ["velocity gain C", "natural frequency", "damping"][i];
            let mut chart = ChartBuilder::on(panel)
                .margin(px(8))
                .caption(name, font(15))
                .x_label_area_size(px(26))
                .y_label_area_size(px(42))
                .build_cartesian_2d((0.8..60.0).log_scale(), (low..high).log_scale())?;
            chart
                .configure_mesh()
                .label_style(font(13))
                .light_line_style(BLACK.mix(0.05))
                .bold_line_style(BLACK.mix(0.15))
                .x_max_light_lines(0)
                .y_max_light_lines(0)
                .x_label_formatter(&sparse)
                .y_label_formatter(&plain)
                .draw()?;
            for s in &self.series {
                let points: Vec<(f64, f64)> = s
                    .points
                    .iter()
                    .map(|(x, e)| (*x, e[i]))
                    .filter(|(_, e)| *e > 0.0 && e.is_finite())
                    .collect();
                let style = s.colour.stroke_width(px(2));
                chart.draw_series(LineSeries::new(points.iter().copied(), style))?;
                let dots = points
                    .iter()
                    .map(|p| Circle::new(*p, px(3), s.colour.filled()));
                chart.draw_series(dots)?;
            }
        }
        for (k, s) in self.series.iter().enumerate() {
            let x = (px(24) + k as u32 * px(195)) as i32;
            let y = px(28) as i32;
            let line = [(x, y), (x + px(20) as i32, y)];
            legend.draw(&PathElement::new(line, s.colour.stroke_width(px(3))))?;
            let style = TextStyle::from(font(13)).pos(Pos::new(HPos::Left, VPos::Center));
            legend.draw(&Text::new(s.name, (x + px(26) as i32, y), style))?;
        }
        area.present()
    }
}

/// 1, 2, 5, 10, ..: between them there is no room.
fn sparse(value: &f64) -> String {
    let text = plain(value);
    match text.as_bytes() {
        [b'1' | b'2' | b'5', zeros @ ..] if zeros.iter().all(|b| *b == b'0') => text,
        _ => String::new(),
    }
}

/// Without exponent or trailing zeros.
fn plain(value: &f64) -> String {
    let digits = (-value.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_decades() {
        assert_eq!(decades([0.02, 72.0].into_iter()), (0.01, 100.0));
        assert_eq!(decades([f64::INFINITY].into_iter()), (0.1, 10.0));
        assert_eq!((plain(&0.01), plain(&100.0)), ("0.01".into(), "100".into()));
        assert_eq!((sparse(&50.0), sparse(&30.0)), ("50".into(), String::new()));
    }
}
