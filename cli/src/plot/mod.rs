//! Pictures: one drawing routine, written as SVG and as PNG.

mod raster;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use crate::plot::raster::{Raster, encode, reduced};

/// Colours that stay apart for colour-blind eyes and in grey (Okabe and Ito).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// The colour of references and measurements.
pub const GREY: RGBColor = RGBColor(110, 110, 110);

/// The colour of a measurement below its model.
pub const PALE: RGBColor = RGBColor(185, 185, 185);

/// More points than the picture has pixels only make the file heavy.
const MAX_POINTS: usize = 2_000;

/// One line with an optional band around it.
pub struct Curve {
    pub name: String,
    pub colour: RGBColor,
    pub points: Vec<(f64, f64)>,
    /// Width of the line in pixels.
    pub width: u32,
    /// Lower and upper edge at each point.
    pub band: Option<Vec<(f64, f64)>>,
}

impl Curve {
    pub fn new(name: impl Into<String>, colour: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            colour,
            points,
            width: 2,
            band: None,
        }
    }
}

/// One pair of axes.
pub struct Panel {
    pub title: String,
    pub x: String,
    pub y: String,
    pub curves: Vec<Curve>,
    /// The ordinate range; from the curves when absent.
    pub range: Option<Range<f64>>,
}

/// Panels under each other, with a common title.
pub struct Figure {
    pub title: String,
    pub panels: Vec<Panel>,
}

/// Width and height of the picture in pixels.
const WIDTH: u32 = 1000;
const PANEL_HEIGHT: u32 = 330;

/// Everything is drawn this much larger, because coordinates are whole pixels:
/// the SVG is scaled by its header, the bitmap is averaged down.
const SCALE: u32 = 3;

/// A length in pixels of the finished picture.
pub fn px(length: u32) -> u32 {
    length * SCALE
}

/// The font at a size in pixels of the finished picture.
pub fn font(size: u32) -> (&'static str, u32) {
    ("sans-serif", px(size))
}

/// What can be drawn on every backend, lengths by [`px`].
pub trait Drawing {
    /// Width and height of the finished picture.
    fn size(&self) -> (u32, u32);

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>>;
}

/// Writes `DIR/NAME.svg` and `DIR/NAME.png`, making `dir` when needed.
///
/// # Errors
///
/// A sentence naming the file that cannot be written.
pub fn save(drawing: &impl Drawing, dir: &Path, name: &str) -> Result<[PathBuf; 2], String> {
    register_fonts();
    std::fs::create_dir_all(dir)
        .map_err(|e| format!("cannot make the directory `{}`: {e}", dir.display()))?;
    let size = drawing.size();
    let large = (px(size.0), px(size.1));
    let svg = dir.join(format!("{name}.svg"));
    let png = dir.join(format!("{name}.png"));
    let failed = |path: &Path, e: String| format!("cannot write `{}`: {e}", path.display());

    let mut text = String::new();
    drawing
        .draw(&SVGBackend::with_string(&mut text, large).into_drawing_area())
        .map_err(|e| failed(&svg, e.to_string()))?;
    let extent = |(w, h): (u32, u32)| format!("width=\"{w}\" height=\"{h}\"");
    let text = text.replacen(&extent(large), &extent(size), 1);
    std::fs::write(&svg, text).map_err(|e| failed(&svg, e.to_string()))?;

    let mut pixels = vec![255; 3 * (large.0 * large.1) as usize];
    drawing
        .draw(&Raster::new(&mut pixels, large).into_drawing_area())
        .map_err(|e| failed(&png, e.to_string()))?;
    encode(&png, size, &reduced(&pixels, size, SCALE)).map_err(|e| failed(&png, e.to_string()))?;
    Ok([svg, png])
}

impl Figure {
    /// Writes `DIR/NAME.svg` and `DIR/NAME.png`, see [`save`].
    ///
    /// # Errors
    ///
    /// As [`save`].
    pub fn save(&self, dir: &Path, name: &str) -> Result<[PathBuf; 2], String> {
        save(self, dir, name)
    }
}

impl Drawing for Figure {
    fn size(&self) -> (u32, u32) {
        (WIDTH, 50 + PANEL_HEIGHT * self.panels.len() as u32)
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.fill(&WHITE)?;
        let area = area.margin(px(8), 0, 0, 0).titled(&self.title, font(20))?;
        let panels = area.split_evenly((self.panels.len(), 1));
        for (panel, area) in self.panels.iter().zip(panels) {
            panel.draw(&area)?;
        }
        area.present()
    }
}

impl Panel {
    /// Draws the pair of axes over the whole of `area`.
    pub fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let points = || self.curves.iter().flat_map(|c| &c.points);
        let x = extent(points().map(|p| p.0), 0.0);
        let y = self
            .range
            .clone()
            .unwrap_or_else(|| extent(points().map(|p| p.1), 0.06));
        let mut chart = ChartBuilder::on(area)
            .margin(px(10))
            .margin_right(px(28))
            .caption(&self.title, font(16))
            .x_label_area_size(px(42))
            .y_label_area_size(px(70))
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .x_desc(&self.x)
            .y_desc(&self.y)
            .label_style(font(14))
            .axis_desc_style(font(15))
            .set_all_tick_mark_size(px(4))
            .axis_style(BLACK.stroke_width(px(1)))
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12).stroke_width(px(1)))
            .x_label_formatter(&|v| tick(*v, &x))
            .y_label_formatter(&|v| tick(*v, &y))
            .draw()?;
        for curve in &self.curves {
            if let Some(band) = &curve.band {
                for edge in outline(&curve.points, band, &y) {
                    let colour = curve.colour.mix(0.16);
                    chart.draw_series(std::iter::once(Polygon::new(edge, colour)))?;
                }
            }
        }
        for curve in &self.curves {
            let style = curve.colour.stroke_width(px(curve.width));
            // Lines that leave the axes are cut there, not drawn over the labels.
            for run in inside(&envelope(&curve.points), &y) {
                chart.draw_series(LineSeries::new(run, style))?;
            }
            // An empty series carries the legend entry exactly once.
            chart
                .draw_series(LineSeries::new(std::iter::empty(), style))?
                .label(&curve.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + px(22) as i32, y)], style));
        }
        if self.curves.len() > 1 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .border_style(BLACK.mix(0.3))
                .label_font(font(14))
                .legend_area_size(px(30))
                .margin(px(6))
                .draw()?;
        }
        Ok(())
    }
}

fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // The bytes are a font of a released crate: they parse, or a test of
        // this module fails.
        let ok = register_font(
            "sans-serif",
            FontStyle::Normal,
            epaint_default_fonts::UBUNTU_LIGHT,
        );
        assert!(ok.is_ok(), "the built-in font is unreadable");
    });
}

/// The range of the finite values, widened by `margin` of itself on both sides.
fn extent(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let (lo, hi) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
            (lo.min(v), hi.max(v))
        });
    if lo > hi {
        return 0.0..1.0;
    }
    let pad = if hi > lo {
        margin * (hi - lo)
    } else {
        0.5 * hi.abs().max(1e-12)
    };
    (lo - pad)..(hi + pad)
}

/// A tick label with as many decimals as the range needs.
fn tick(v: f64, range: &Range<f64>) -> String {
    let span = range.end - range.start;
    let largest = range.start.abs().max(range.end.abs());
    if !(1e-3..1e5).contains(&largest) {
        return format!("{v:.1e}");
    }
    let decimals = (1 - span.log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{v:.decimals$}");
    // Rounding must not leave a negative zero on the axis.
    if text
        .trim_start_matches('-')
        .bytes()
        .all(|b| b == b'0' || b == b'.')
    {
        text.replace('-', "")
    } else {
        text
    }
}

/// Outlines of the finite stretches of a band, cut at the axes, with at most
/// [`MAX_POINTS`] points to each edge.
fn outline(points: &[(f64, f64)], band: &[(f64, f64)], range: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let step = points.len().div_ceil(MAX_POINTS).max(1);
    let edges: Vec<(f64, f64, f64)> = points
        .iter()
        .zip(band)
        .step_by(step)
        .map(|(p, b)| (p.0, b.0, b.1))
        .collect();
    edges
        .split(|e| !(e.1.is_finite() && e.2.is_finite()))
        .filter(|run| run.len() > 1)
        .map(|run| {
            let cut = |v: f64| v.clamp(range.start, range.end);
            let upper = run.iter().map(|e| (e.0, cut(e.2)));
            upper
                .chain(run.iter().rev().map(|e| (e.0, cut(e.1))))
                .collect()
        })
        .collect()
}

/// The curve with each long run of points replaced by its lowest and highest,
/// in their order, so that no peak is lost.
fn envelope(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let chunk = (2 * points.len()).div_ceil(MAX_POINTS).max(1);
    if chunk <= 2 {
        return points.to_vec();
    }
    points
        .chunks(chunk)
        .flat_map(|c| {
            let by = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
            let (lo, hi) = (c.iter().min_by(by), c.iter().max_by(by));
            match (lo, hi) {
                (Some(&lo), Some(&hi)) if lo.0 <= hi.0 => [lo, hi],
                (Some(&lo), Some(&hi)) => [hi, lo],
                _ => [c[0], c[0]],
            }
        })
        .collect()
}

/// The parts of a polyline inside `range`, cut where it crosses the bounds.
fn inside(points: &[(f64, f64)], range: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    let within = |v: f64| v >= range.start && v <= range.end;
    let cut = |a: (f64, f64), b: (f64, f64)| {
        let bound = if a.1 > range.end || b.1 > range.end {
            range.end
        } else {
            range.start
        };
        (a.0 + (b.0 - a.0) * (bound - a.1) / (b.1 - a.1), bound)
    };
    let mut previous: Option<(f64, f64)> = None;
    for &p in points {
        if !p.1.is_finite() {
            runs.push(Vec::new());
            previous = None;
            continue;
        }
        let inside_now = within(p.1);
        if let Some(last) = previous {
            match (within(last.1), inside_now) {
                (true, false) => {
                    let edge = cut(last, p);
                    if let Some(run) = runs.last_mut() {
                        run.push(edge);
                    }
                    runs.push(Vec::new());
                }
                (false, true) => runs.push(vec![cut(last, p)]),
                _ => {}
            }
        }
        if inside_now && let Some(run) = runs.last_mut() {
            run.push(p);
        }
        previous = Some(p);
    }
    runs.retain(|r| r.len() > 1);
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let points: Vec<_> = (0..50_000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| (t, t.sin()))
            .collect();
        let mut curve = Curve::new("sine", COLOURS[0], points.clone());
        curve.band = Some(points.iter().map(|p| (p.1 - 0.1, p.1 + 0.1)).collect());
        let panel = Panel {
            title: "a panel".into(),
            x: "t [s]".into(),
            y: "y".into(),
            curves: vec![curve],
            range: Some(-0.5..0.5),
        };
        Figure {
            title: "a figure".into(),
            panels: vec![panel],
        }
    }

    #[test]
    fn both_formats_are_written_with_text_in_them() {
        let dir = std::env::temp_dir().join(format!("trendid-plot-{}", std::process::id()));
        let [svg, png] = figure().save(&dir, "figure").unwrap();
        let svg = std::fs::read_to_string(svg).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("a panel"));
        assert!(svg.len() < 200_000, "{} bytes", svg.len());
        let bytes = std::fs::read(png).unwrap();
        assert_eq!(&bytes[1..4], b"PNG");
        std::fs::remove_dir_all(dir).unwrap();
    }

    #[test]
    fn a_directory_that_cannot_be_made_is_named() {
        let file = std::env::temp_dir().join(format!("trendid-plot-file-{}", std::process::id()));
        std::fs::write(&file, "x").unwrap();
        let sentence = figure().save(&file.join("sub"), "figure").unwrap_err();
        assert!(
            sentence.starts_with("cannot make the directory"),
            "{sentence}"
        );
        std::fs::remove_file(file).unwrap();
    }

    #[test]
    fn lines_are_cut_at_the_axes() {
        let runs = inside(&[(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)], &(-1.0..1.0));
        assert_eq!(
            runs,
            [vec![(0.0, 0.0), (0.5, 1.0)], vec![(1.5, 1.0), (2.0, 0.0)]]
        );
        assert_eq!(
            inside(
                &[(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 0.0)],
                &(-1.0..1.0)
            )
            .len(),
            1
        );
    }

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut points: Vec<_> = (0..30_000).map(|k| (f64::from(k), 0.0)).collect();
        points[12_345].1 = 7.0;
        points[20_001].1 = -3.0;
        let thin = envelope(&points);
        assert!(thin.len() <= MAX_POINTS + 2);
        assert!(thin.contains(&(12_345.0, 7.0)) && thin.contains(&(20_001.0, -3.0)));
    }
}
