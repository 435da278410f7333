//! What pictures are drawn on: it records shapes, and draws them as pixels when it is finished.

use std::io;

use crate::error::Result;
use crate::plot::shape::{self, Anchor, FINE, Point, Shape};
use crate::plot::{Color, font};

/// A white area to draw on; coordinates are in pixels from the upper left corner.
pub(super) struct Canvas {
    size: [u32; 2],
    shapes: Vec<Shape>,
}

/// A point in parts of pixels.
fn fine(point: [f64; 2]) -> Point {
    let [x, y] = point.map(|value| (value * f64::from(FINE)).round() as i32);
    (x, y)
}

impl Canvas {
    /// # Errors
    /// If the compiled-in font cannot be read.
    pub(super) fn new(size: [u32; 2]) -> Result<Canvas> {
        font::check().map(|()| Canvas { size, shapes: Vec::new() })
    }

    /// The pixels, and the shapes to be written as SVG.
    ///
    /// # Errors
    /// If the backend fails, which is not expected.
    pub(super) fn finish(self) -> Result<(Vec<u8>, Vec<Shape>)> {
        Ok((shape::pixels(self.size, &self.shapes)?, self.shapes))
    }

    /// Lines through the points of each piece, with round ends and corners.
    pub(super) fn lines(&mut self, pieces: &[Vec<[f64; 2]>], width: f64, color: Color) {
        let width = (width * f64::from(FINE)).round() as u32;
        let lines = pieces.iter().map(|piece| piece.iter().copied().map(fine).collect());
        self.shapes.extend(lines.map(|points| Shape::Line { points, width, color }));
    }

    pub(super) fn dots(&mut self, centers: &[[f64; 2]], radius: f64, color: Color) {
        let radius = (radius * f64::from(FINE)).round() as u32;
        let mut centers: Vec<Point> = centers.iter().copied().map(fine).collect();
        centers.dedup();
        self.shapes.extend(centers.into_iter().map(|center| Shape::Dot { center, radius, color }));
    }

    pub(super) fn polygon(&mut self, corners: &[[f64; 2]], color: Color) {
        self.shapes.push(Shape::Polygon { corners: corners.iter().copied().map(fine).collect(), color });
    }

    pub(super) fn rectangle(&mut self, [left, top, right, bottom]: [f64; 4], color: Color, percent: u8) {
        self.shapes.push(Shape::Rectangle { corners: [[left, top], [right, bottom]].map(fine), color, percent });
    }

    /// A black text of `size` pixels per em whose baseline starts, is centred or ends at `at`; upright texts run upwards.
    pub(super) fn text(&mut self, text: &str, at: [f64; 2], size: f64, anchor: Anchor, upright: bool) {
        // XML does not allow all characters
        let allowed = |c: char| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { '\u{fffd}' } else { c };
        let size = (size * f64::from(FINE)).round() as u32;
        self.shapes.push(Shape::Text {
            text: text.chars().map(allowed).collect(),
            at: fine(at),
            size,
            anchor,
            upright,
        });
    }

    /// A text in the middle of `room` pixels, smaller if it is too long.
    pub(super) fn fitted_text(&mut self, text: &str, at: [f64; 2], size: f64, room: f64, upright: bool) {
        let fitted = size * (room / font::width(text, size)).clamp(0.3, 1.0);
        self.text(text, at, fitted, Anchor::Middle, upright);
    }

    /// Cells of given colours, top row first, in a rectangle. Cells smaller than pixels are averaged.
    pub(super) fn cells(&mut self, [left, top, right, bottom]: [f64; 4], columns: usize, colors: Vec<Color>) {
        self.shapes.push(Shape::Cells { corners: [[left, top], [right, bottom]].map(fine), columns, colors });
    }
}

/// Writes pixels as a PNG file, with a palette if 256 colours suffice.
pub(super) fn png_file(out: impl io::Write, size: [u32; 2], rgb: &[u8]) -> io::Result<()> {
    let mut palette = std::collections::HashMap::new();
    let mut colors = Vec::new();
    let pixels = rgb.chunks_exact(3).map(|pixel| {
        let next = u8::try_from(palette.len()).ok();
        *palette.entry(pixel).or_insert_with(|| {
            colors.extend_from_slice(pixel);
            next
        })
    });
    let indexed: Option<Vec<u8>> = pixels.collect();
    let mut encoder = png::Encoder::new(out, size[0], size[1]);
    encoder.set_compression(png::Compression::High);
    if indexed.is_some() {
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(colors);
        encoder.set_filter(png::Filter::NoFilter);
    } else {
        encoder.set_color(png::ColorType::Rgb);
    }
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(indexed.as_deref().unwrap_or(rgb)).map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels, three bytes each, in rows.
    fn rows(canvas: Canvas) -> Vec<Vec<u8>> {
        let row = 3 * canvas.size[0] as usize;
        canvas.finish().unwrap().0.chunks_exact(row).map(<[u8]>::to_vec).collect()
    }

    fn red(row: &[u8]) -> Vec<u8> {
        row.iter().step_by(3).copied().collect()
    }

    #[test]
    fn slanted_lines_have_smooth_edges_and_level_ones_are_crisp() {
        let mut canvas = Canvas::new([60, 40]).unwrap();
        canvas.lines(&[vec![[5.0, 5.0], [54.3, 31.7]]], 3.0, Color::BLACK);
        let rgb = rows(canvas).concat();
        let between: std::collections::BTreeSet<u8> = rgb.iter().copied().filter(|c| (1..255).contains(c)).collect();
        assert!(between.len() > 8, "{between:?}");
        // as much ink as the line is wide: length 56.1, width 3, round ends
        let ink: f64 = red(&rgb).iter().map(|&c| 1.0 - f64::from(c) / 255.0).sum();
        assert!((ink - 56.06 * 3.0 - 7.07).abs() < 4.0, "{ink}");
        let mut canvas = Canvas::new([20, 9]).unwrap();
        canvas.lines(&[vec![[5.0, 4.0], [15.0, 4.0]]], 2.0, Color::BLACK);
        let rows = rows(canvas);
        assert_eq!([2, 3, 4, 5].map(|y| red(&rows[y])[10]), [255, 0, 0, 255]);
    }

    #[test]
    fn overlapping_shapes_of_one_kind_are_painted_once() {
        let dots = |count: usize| {
            let mut canvas = Canvas::new([9, 9]).unwrap();
            canvas.dots(&vec![[4.5, 4.5]; count], 2.0, Color::BLACK);
            canvas
        };
        assert_eq!(rows(dots(3)), rows(dots(1)));
        let mut canvas = dots(1);
        canvas.rectangle([0.0, 0.0, 9.0, 4.0], Color::WHITE, 100);
        let rows = rows(canvas);
        assert_eq!((red(&rows[3])[4], red(&rows[4])[4]), (255, 0));
    }

    #[test]
    fn cells_smaller_than_pixels_are_averaged() {
        let mut canvas = Canvas::new([4, 3]).unwrap();
        let grey = |value: u8| Color(value, value, value);
        canvas.cells([0.0, 0.0, 4.0, 1.0], 12, [0, 90, 180].map(grey).repeat(4));
        canvas.cells([0.0, 1.0, 4.0, 3.0], 2, vec![grey(10), grey(200)]);
        let rows = rows(canvas);
        assert_eq!(red(&rows[0]), [90; 4]);
        assert_eq!(red(&rows[2]), [10, 10, 200, 200]);
    }

    #[test]
    fn few_colours_become_a_palette() {
        for (colors, expected) in
            [(2_usize, png::ColorType::Indexed), (256, png::ColorType::Indexed), (257, png::ColorType::Rgb)]
        {
            let rgb: Vec<u8> = (0..300).flat_map(|k| [(k % colors) as u8, ((k % colors) / 256) as u8, 7]).collect();
            let mut file = Vec::new();
            png_file(&mut file, [30, 10], &rgb).unwrap();
            let mut decoder = png::Decoder::new(io::Cursor::new(file));
            assert_eq!(decoder.read_header_info().unwrap().color_type, expected);
            decoder.set_transformations(png::Transformations::EXPAND);
            let mut reader = decoder.read_info().unwrap();
            let mut read = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut read).unwrap();
            assert_eq!(read, rgb);
        }
    }
}
