//! A picture in pixels: drawn several times too large and averaged down, so
//! that lines have smooth edges.

use std::path::Path;

use plotters::backend::BitMapBackend;
use plotters::prelude::DrawingBackend;
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingErrorKind};

/// A bitmap whose thick paths are drawn segment by segment.
///
/// plotters joins thick segments by mitres, which stand out far beyond a noisy
/// curve; a disc at each corner joins them instead.
pub struct Raster<'a>(BitMapBackend<'a>);

type Fault<'a> = DrawingErrorKind<<BitMapBackend<'a> as DrawingBackend>::ErrorType>;

impl<'a> Raster<'a> {
    /// A raster over `pixels`, three bytes each.
    pub fn new(pixels: &'a mut [u8], size: (u32, u32)) -> Self {
        Self(BitMapBackend::with_buffer(pixels, size))
    }
}

impl<'a> DrawingBackend for Raster<'a> {
    type ErrorType = <BitMapBackend<'a> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<(), Fault<'a>> {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Result<(), Fault<'a>> {
        self.0.present()
    }

    fn draw_pixel(&mut self, point: BackendCoord, colour: BackendColor) -> Result<(), Fault<'a>> {
        self.0.draw_pixel(point, colour)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        bottom_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Result<(), Fault<'a>> {
        self.0.draw_rect(upper_left, bottom_right, style, fill)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Result<(), Fault<'a>> {
        let radius = style.stroke_width() / 2;
        let mut last: Option<BackendCoord> = None;
        for point in path {
            if let Some(last) = last
                && last != point
            {
                self.0.draw_line(last, point, style)?;
            }
            if radius > 1 {
                self.0.draw_circle(point, radius, &style.color(), true)?;
            }
            last = Some(point);
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Result<(), Fault<'a>> {
        self.0.fill_polygon(corners, style)
    }
}

/// The average of each square of `factor` by `factor` pixels.
pub fn reduced(pixels: &[u8], size: (u32, u32), factor: u32) -> Vec<u8> {
    let (width, height, factor) = (size.0 as usize, size.1 as usize, factor as usize);
    let row = 3 * width * factor;
    let mut out = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let square = (0..factor * factor).map(|i| {
                    let (dy, dx) = (i / factor, i % factor);
                    u32::from(pixels[(y * factor + dy) * row + 3 * (x * factor + dx) + channel])
                });
                out.push((square.sum::<u32>() / (factor * factor) as u32) as u8);
            }
        }
    }
    out
}

/// Writes a PNG file.
///
/// # Errors
///
/// What the file system or the encoder reports.
pub fn encode(path: &Path, size: (u32, u32), pixels: &[u8]) -> Result<(), png::EncodingError> {
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_averaged() {
        // 2 by 1 pixels from 4 by 2: the left square is half black.
        let mut big = vec![255; 3 * 4 * 2];
        big[..6].fill(0);
        assert_eq!(reduced(&big, (2, 1), 2), [127, 127, 127, 255, 255, 255]);
    }
}
