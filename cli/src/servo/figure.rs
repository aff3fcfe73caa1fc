//! The picture of a run of the loop: position, error, valve, parameters with their bands, states.

use std::path::{Path, PathBuf};

use plotters::prelude::*;
use trendid::servo::State;

use crate::plot::{
    Area, COLOURS, Curve, Drawing, Drawn, GREY, Panel, font, px, save as save_drawing,
};

/// One sample.
pub(super) struct Row {
    pub t: f64,
    pub position: f64,
    pub reference: f64,
    pub command: f64,
    pub controlling: bool,
}

/// The signals of a run in the picture.
#[derive(Default)]
pub(super) struct Course {
    pub rows: Vec<Row>,
    /// Time, then value and standard deviation of C, w0 and xi.
    pub parameters: Vec<(f64, [(f64, f64); 3])>,
    /// Time, then C, w0 and xi of the model in use.
    pub used: Vec<(f64, [f64; 3])>,
    /// Times at which the state changed, and the state from then on.
    pub states: Vec<(f64, State)>,
    /// Times at which a model reached the controller.
    pub retuned: Vec<f64>,
}

/// Writes the picture as `DIR/NAME.svg`.
///
/// # Errors
///
/// A sentence naming the file that cannot be written.
pub(super) fn save(
    course: &Course,
    title: String,
    dir: &Path,
    name: &str,
) -> Result<PathBuf, String> {
    let picture = Picture {
        title,
        panels: panels(course),
        strip: Strip {
            states: &course.states,
            retuned: &course.retuned,
            end: course.rows.last().map_or(1.0, |r| r.t),
        },
    };
    save_drawing(&picture, dir, name)
}

/// Error beyond this is off the axis: the start of the first movement after a defect.
const LARGEST_ERROR: f64 = 4.0;

/// Reference minus true position, NaN while the loop is open.
fn error(r: &Row) -> f64 {
    if r.controlling {
        r.reference - r.position
    } else {
        f64::NAN
    }
}

fn panels(course: &Course) -> Vec<Panel> {
    let line = |name: &str, colour, of: &dyn Fn(&Row) -> f64| {
        let mut curve = Curve::new(
            name,
            colour,
            course.rows.iter().map(|r| (r.t, of(r))).collect(),
        );
        curve.width = 1;
        curve
    };
    let panel = |title: &str, y: &str, curves, range| Panel {
        title: title.into(),
        x: String::new(),
        y: y.into(),
        curves,
        range,
    };
    let errors = course.rows.iter().map(|r| error(r).abs());
    let largest = errors
        .filter(|e| e.is_finite())
        .fold(0.5_f64, f64::max)
        .min(LARGEST_ERROR);
    let mut panels = vec![
        panel(
            "position and reference",
            "x [mm]",
            vec![
                line("reference", COLOURS[1], &|r| r.reference),
                line("position", COLOURS[0], &|r| r.position),
            ],
            None,
        ),
        panel(
            "error: reference minus true position, while the loop is closed",
            "e [mm]",
            vec![line("error", COLOURS[0], &error)],
            Some(-1.05 * largest..1.05 * largest),
        ),
        panel(
            "command of the valve",
            "u",
            vec![line("command", COLOURS[2], &|r| r.command)],
            Some(-1.05..1.05),
        ),
    ];
    let titles = [
        ("velocity gain C, band +-2 sigma", "C [mm/s]"),
        ("natural frequency, band +-2 sigma", "w0 [rad/s]"),
        ("damping, band +-2 sigma", "xi"),
    ];
    for (j, (title, y)) in titles.into_iter().enumerate() {
        panels.push(parameter_panel(course, j, title, y));
    }
    panels
}

fn parameter_panel(course: &Course, j: usize, title: &str, y: &str) -> Panel {
    let points = course
        .parameters
        .iter()
        .map(|(t, p)| (*t, p[j].0))
        .collect();
    let mut estimate = Curve::new("estimate", COLOURS[j], points);
    estimate.band = Some(
        course
            .parameters
            .iter()
            .map(|(_, p)| (p[j].0 - 2.0 * p[j].1, p[j].0 + 2.0 * p[j].1))
            .collect(),
    );
    let used = course.used.iter().map(|(t, p)| (*t, p[j])).collect();
    let mut used = Curve::new("model in use", GREY, used);
    used.width = 1;
    // At rest the free estimate may wander far; the axis is about what the controller uses.
    let high = course
        .used
        .iter()
        .map(|(_, p)| p[j])
        .filter(|v| v.is_finite())
        .fold(0.0_f64, f64::max);
    Panel {
        title: title.into(),
        x: String::new(),
        y: y.into(),
        curves: vec![estimate, used],
        range: (high > 0.0).then_some(0.0..2.2 * high),
    }
}

/// Panels above each other and the states below them.
struct Picture<'a> {
    title: String,
    panels: Vec<Panel>,
    strip: Strip<'a>,
}

const WIDTH: u32 = 1100;
const PANEL: u32 = 200;
const STRIP: u32 = 250;
const HEAD: u32 = 46;

impl Drawing for Picture<'_> {
    fn size(&self) -> (u32, u32) {
        (WIDTH, HEAD + PANEL * self.panels.len() as u32 + STRIP)
    }

    fn draw(&self, area: &Area) -> Drawn {
        area.fill(&WHITE)?;
        let area = area.margin(px(8), 0, 0, 0).titled(&self.title, font(19))?;
        let (upper, lower) = area.split_vertically(px(PANEL) * self.panels.len() as u32);
        for (panel, area) in self
            .panels
            .iter()
            .zip(upper.split_evenly((self.panels.len(), 1)))
        {
            panel.draw(&area)?;
        }
        self.strip.draw(&lower)?;
        area.present()
    }
}

/// The states over time, one line each.
struct Strip<'a> {
    states: &'a [(f64, State)],
    retuned: &'a [f64],
    end: f64,
}

/// The lines from below.
const LINES: [&str; 8] = [
    "failed",
    "rejected",
    "frozen",
    "adapting",
    "verified",
    "identifying",
    "exciting",
    "idle",
];

/// Line of a state; a code beyond the lines is drawn on the lowest.
fn line_of(state: State) -> usize {
    (LINES.len() - 1).saturating_sub(usize::from(state.code()))
}

impl Strip<'_> {
    fn draw(&self, area: &Area) -> Drawn {
        let lines = LINES.len() as f64;
        let mut chart = ChartBuilder::on(area)
            .margin(px(10))
            .margin_right(px(28))
            .caption(
                "state of the supervisor; ticks below: a model reached the controller",
                font(16),
            )
            .x_label_area_size(px(42))
            .y_label_area_size(px(70))
            .build_cartesian_2d(0.0..self.end, -1.0..lines)?;
        chart
            .configure_mesh()
            .x_desc("t [s]")
            .label_style(font(14))
            .axis_desc_style(font(15))
            .set_all_tick_mark_size(px(4))
            .axis_style(BLACK.stroke_width(px(1)))
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12).stroke_width(px(1)))
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_labels(LINES.len() + 2)
            .y_label_formatter(&|v| {
                let line = v.round();
                if line < 0.0 {
                    return String::new();
                }
                LINES
                    .get(line as usize)
                    .map_or(String::new(), |name| (*name).to_owned())
            })
            .draw()?;
        // A state of a few samples is still a line of some width.
        let least = self.end / 700.0;
        for (k, (begin, state)) in self.states.iter().enumerate() {
            let end = self.states.get(k + 1).map_or(self.end, |next| next.0);
            let line = line_of(*state);
            let colour = match state {
                State::Failed(_) | State::Rejected(_) => COLOURS[1],
                State::Frozen => COLOURS[4],
                State::Adapting | State::Verified => COLOURS[2],
                _ => COLOURS[5],
            };
            let y = line as f64;
            chart.draw_series(std::iter::once(Rectangle::new(
                [(*begin, y - 0.35), (end.max(begin + least), y + 0.35)],
                colour.filled(),
            )))?;
        }
        for &t in self.retuned {
            chart.draw_series(std::iter::once(PathElement::new(
                [(t, -0.95), (t, -0.55)],
                BLACK.stroke_width(px(1)),
            )))?;
        }
        Ok(())
    }
}
