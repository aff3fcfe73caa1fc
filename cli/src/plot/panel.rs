//! One pair of axes with its curves.

use std::ops::Range;

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{Area, Drawn, font, px};
use super::lines::{envelope, extent, inside, outline, tick};

/// One line with an optional band around it.
pub(crate) struct Curve {
    pub name: String,
    pub colour: RGBColor,
    pub points: Vec<(f64, f64)>,
    /// Width of the line in pixels.
    pub width: u32,
    /// Lower and upper edge at each point.
    pub band: Option<Vec<(f64, f64)>>,
}

impl Curve {
    pub(crate) fn new(name: impl Into<String>, colour: RGBColor, points: Vec<(f64, f64)>) -> Self {
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
pub(crate) struct Panel {
    pub title: String,
    pub x: String,
    pub y: String,
    pub curves: Vec<Curve>,
    /// The ordinate range; from the curves when absent.
    pub range: Option<Range<f64>>,
}

impl Panel {
    /// Draws the pair of axes over the whole of `area`.
    pub(crate) fn draw(&self, area: &Area) -> Drawn {
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
        self.draw_curves(&mut chart, &y)?;
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

    fn draw_curves(&self, chart: &mut Chart, y: &Range<f64>) -> Drawn {
        for curve in &self.curves {
            if let Some(band) = &curve.band {
                for edge in outline(&curve.points, band, y) {
                    let colour = curve.colour.mix(0.16);
                    chart.draw_series(std::iter::once(Polygon::new(edge, colour)))?;
                }
            }
        }
        for curve in &self.curves {
            let style = curve.colour.stroke_width(px(curve.width));
            // Lines that leave the axes are cut there, not drawn over the labels.
            for run in inside(&envelope(&curve.points), y) {
                chart.draw_series(LineSeries::new(run, style))?;
            }
            // An empty series carries the legend entry exactly once.
            chart
                .draw_series(LineSeries::new(std::iter::empty(), style))?
                .label(&curve.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + px(22) as i32, y)], style));
        }
        Ok(())
    }
}

/// The coordinates of a panel.
type Chart<'c, 'a> = ChartContext<'c, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
