//! Pictures as SVG.

mod canvas;
mod lines;
mod panel;

use std::path::{Path, PathBuf};

use plotters::prelude::*;

pub(crate) use canvas::{Area, Drawn, font, px};
pub(crate) use panel::{Curve, Panel};

/// Colours that stay apart for colour-blind eyes and in grey (Okabe and Ito).
pub(crate) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// The colour of references and measurements.
pub(crate) const GREY: RGBColor = RGBColor(110, 110, 110);

/// The colour of a measurement below its model.
pub(crate) const PALE: RGBColor = RGBColor(185, 185, 185);

/// Panels under each other, with a common title.
pub(crate) struct Figure {
    pub title: String,
    pub panels: Vec<Panel>,
}

/// Width and height of the picture in pixels.
const WIDTH: u32 = 1000;
const PANEL_HEIGHT: u32 = 330;

/// Elements of a picture, lengths by [`px`].
pub(crate) trait Drawing {
    /// Width and height of the finished picture.
    fn size(&self) -> (u32, u32);

    fn draw(&self, area: &Area) -> Drawn;
}

/// Writes `DIR/NAME.svg`, making `dir` when needed.
///
/// # Errors
///
/// A sentence naming the file that cannot be written.
pub(crate) fn save(drawing: &impl Drawing, dir: &Path, name: &str) -> Result<PathBuf, String> {
    std::fs::create_dir_all(dir)
        .map_err(|e| format!("cannot make the directory `{}`: {e}", dir.display()))?;
    let path = dir.join(format!("{name}.svg"));
    let failed = |e: String| format!("cannot write `{}`: {e}", path.display());
    let size = drawing.size();
    let large = (px(size.0), px(size.1));
    let mut text = String::new();
    drawing
        .draw(&SVGBackend::with_string(&mut text, large).into_drawing_area())
        .map_err(|e| failed(e.to_string()))?;
    let extent = |(w, h): (u32, u32)| format!("width=\"{w}\" height=\"{h}\"");
    let text = text.replacen(&extent(large), &extent(size), 1);
    std::fs::write(&path, text).map_err(|e| failed(e.to_string()))?;
    Ok(path)
}

impl Figure {
    /// Writes `DIR/NAME.svg`, see [`save`].
    ///
    /// # Errors
    ///
    /// As [`save`].
    pub(crate) fn save(&self, dir: &Path, name: &str) -> Result<PathBuf, String> {
        save(self, dir, name)
    }
}

impl Drawing for Figure {
    fn size(&self) -> (u32, u32) {
        (WIDTH, 50 + PANEL_HEIGHT * self.panels.len() as u32)
    }

    fn draw(&self, area: &Area) -> Drawn {
        area.fill(&WHITE)?;
        let area = area.margin(px(8), 0, 0, 0).titled(&self.title, font(20))?;
        let panels = area.split_evenly((self.panels.len(), 1));
        for (panel, area) in self.panels.iter().zip(panels) {
            panel.draw(&area)?;
        }
        area.present()
    }
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
    fn a_picture_is_written_with_text_in_it() {
        let dir = std::env::temp_dir().join(format!("trendid-plot-{}", std::process::id()));
        let svg = figure().save(&dir, "figure").unwrap();
        let svg = std::fs::read_to_string(svg).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("a panel"));
        assert!(svg.len() < 200_000, "{} bytes", svg.len());
        // Scaled down by its header to the size of the figure.
        assert!(svg.contains("width=\"1000\" height=\"380\" viewBox=\"0 0 3000 1140\""));
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
}
