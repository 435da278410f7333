//! The canvas of pictures: pixels, drawn by tiny-skia, and the same shapes as elements of an SVG document.

use std::io;

use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

use crate::error::Result;
use crate::file::failed;
use crate::plot::{Color, font};

/// Points per pixel along each axis at which cells are sampled.
const SAMPLES: usize = 4;
/// Distances below this part of a pixel are not seen.
const SEEN: f64 = 0.25;

/// Which point of a text is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// An element of an SVG document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Element {
    Xml(String),
    /// An image of cells: its attributes, its size, and red, green and blue of each cell.
    Cells {
        attributes: String,
        size: [u32; 2],
        rgb: Vec<u8>,
    },
}

/// A white area to draw on; coordinates are in pixels from the upper left corner.
pub(super) struct Canvas {
    pixels: Pixmap,
    elements: Vec<Element>,
}

/// A length in an SVG document, to a hundredth of a pixel.
fn short(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

fn paint(Color(red, green, blue): Color, percent: u8) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, (255 * u32::from(percent) / 100) as u8);
    paint
}

/// The path through the points of each piece, and its data in SVG.
fn path(pieces: &[Vec<[f64; 2]>]) -> (Option<Path>, String) {
    let (mut path, mut data) = (PathBuilder::new(), String::new());
    for piece in pieces {
        let Some((&[x, y], rest)) = piece.split_first() else { continue };
        path.move_to(x as f32, y as f32);
        data += &format!("M{} {}", short(x), short(y));
        // a point alone is a line without length
        for &[x, y] in if rest.is_empty() { piece } else { rest } {
            path.line_to(x as f32, y as f32);
            data += &format!("L{} {}", short(x), short(y));
        }
    }
    (path.finish(), data)
}

impl Canvas {
    /// # Errors
    /// If the compiled-in font cannot be read, or there is no memory for the pixels.
    pub(super) fn new([width, height]: [u32; 2]) -> Result<Canvas> {
        font::check()?;
        let pixels = Pixmap::new(width, height);
        let mut pixels = pixels.ok_or_else(|| failed("a picture".as_ref(), io::ErrorKind::OutOfMemory.into()))?;
        pixels.fill(tiny_skia::Color::WHITE);
        Ok(Canvas { pixels, elements: Vec::new() })
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.pixels.width(), self.pixels.height()]
    }

    /// Red, green and blue of the pixels, and the elements of the SVG document.
    pub(super) fn finish(self) -> (Vec<u8>, Vec<Element>) {
        let rgb = self.pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
        (rgb.collect(), self.elements)
    }

    fn element(&mut self, xml: String) {
        self.elements.push(Element::Xml(xml));
    }

    fn fill(&mut self, path: Option<Path>, color: Color, percent: u8) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, &paint(color, percent), FillRule::Winding, Transform::identity(), None);
        }
    }

    /// Lines through the points of each piece, with round ends and corners.
    pub(super) fn lines(&mut self, pieces: &[Vec<[f64; 2]>], width: f64, color: Color) {
        let (path, data) = path(pieces);
        let Some(path) = path else { return };
        let (line_cap, line_join) = (LineCap::Round, LineJoin::Round);
        let stroke = Stroke { width: width as f32, line_cap, line_join, ..Stroke::default() };
        self.pixels.stroke_path(&path, &paint(color, 100), &stroke, Transform::identity(), None);
        self.element(format!("<path d=\"{data}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"/>"));
    }

    pub(super) fn polygon(&mut self, corners: &[[f64; 2]], color: Color) {
        let (path, data) = path(&[corners.to_vec()]);
        self.fill(path, color, 100);
        self.element(format!("<path d=\"{data}\" fill=\"{color}\"/>"));
    }

    /// Discs; one that covers the previous one is left out.
    pub(super) fn dots(&mut self, centers: &[[f64; 2]], radius: f64, color: Color) {
        let mut centers = centers.to_vec();
        centers.dedup_by(|a, b| (0..2).all(|axis| (a[axis] - b[axis]).abs() < SEEN));
        let mut path = PathBuilder::new();
        for &[x, y] in &centers {
            path.push_circle(x as f32, y as f32, radius as f32);
            let (x, y) = (short(x), short(y));
            self.element(format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{color}\"/>"));
        }
        self.fill(path.finish(), color, 100);
    }

    pub(super) fn rectangle(&mut self, [left, top, right, bottom]: [f64; 4], color: Color, percent: u8) {
        let area = Rect::from_ltrb(left as f32, top as f32, right as f32, bottom as f32);
        self.fill(area.map(PathBuilder::from_rect), color, percent);
        let (width, height) = (short(right - left), short(bottom - top));
        self.element(format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\" fill=\"{color}\" \
            fill-opacity=\"{percent}%\"/>",
            short(left),
            short(top),
        ));
    }

    /// A black text of `size` pixels per em whose baseline starts, is centred or ends at a point; upright texts run
    /// upwards.
    pub(super) fn text(&mut self, text: &str, at: [f64; 2], size: f64, anchor: Anchor, upright: bool) {
        let [x, y] = at;
        // XML does not allow all characters
        let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
        let text = text.replace(forbidden, "\u{fffd}");
        let (share, name) = match anchor {
            Anchor::Start => (0.0, "start"),
            Anchor::Middle => (0.5, "middle"),
            Anchor::End => (1.0, "end"),
        };
        let (along, across) = if upright { (-y, x.round()) } else { (x, y.round()) };
        let [width, height] = self.size().map(|side| side as i32);
        let data = self.pixels.data_mut();
        font::draw(&text, size, [along - share * font::width(&text, size), across], &mut |u, v, covered| {
            let [x, y] = if upright { [v, -u - 1] } else { [u, v] };
            if (0..width).contains(&x) && (0..height).contains(&y) {
                let pixel = &mut data[4 * (y * width + x) as usize..][..3];
                pixel.iter_mut().for_each(|value| *value = (f32::from(*value) * (1.0 - covered)).round() as u8);
            }
        });
        let (x, y, size) = (short(x), short(y), short(size));
        let turned = if upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.element(format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{name}\"{turned}>{text}</text>"
        ));
    }

    /// A text in the middle of `room` pixels, smaller if it is too long.
    pub(super) fn fitted_text(&mut self, text: &str, at: [f64; 2], size: f64, room: f64, upright: bool) {
        let fitted = size * (room / font::width(text, size)).clamp(0.3, 1.0);
        self.text(text, at, fitted, Anchor::Middle, upright);
    }

    /// Cells of given colours, top row first, in a rectangle of whole pixels. Cells smaller than pixels are averaged.
    pub(super) fn cells(&mut self, area: [f64; 4], columns: usize, colors: &[Color]) {
        let rows = colors.len() / columns;
        let [left, top, right, bottom] = area.map(|edge| edge as usize);
        let (width, height, of_picture) = (right - left, bottom - top, self.pixels.width() as usize);
        let cell = |sample: usize, pixels: usize, cells: usize| (2 * sample + 1) * cells / (2 * SAMPLES * pixels);
        let along: Vec<usize> = (0..SAMPLES * width).map(|sample| cell(sample, width, columns)).collect();
        let data = self.pixels.data_mut();
        for y in 0..height {
            let samples = SAMPLES * y..SAMPLES * (y + 1);
            let lines: Vec<&[Color]> =
                samples.map(|sample| &colors[cell(sample, height, rows) * columns..][..columns]).collect();
            for (x, across) in along.chunks_exact(SAMPLES).enumerate() {
                let mut sum = [0; 3];
                for Color(red, green, blue) in lines.iter().flat_map(|line| across.iter().map(|&i| line[i])) {
                    sum = [sum[0] + usize::from(red), sum[1] + usize::from(green), sum[2] + usize::from(blue)];
                }
                let at = 4 * ((top + y) * of_picture + left + x);
                data[at..at + 3].copy_from_slice(&sum.map(|sum| (sum / (SAMPLES * SAMPLES)) as u8));
            }
        }
        // viewers smooth an image unless it has more cells than pixels
        let sharp = if width >= columns && height >= rows { " style=\"image-rendering:pixelated\"" } else { "" };
        let attributes = format!(
            "x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\"{sharp}"
        );
        let rgb = colors.iter().flat_map(|&Color(red, green, blue)| [red, green, blue]).collect();
        self.elements.push(Element::Cells { attributes, size: [columns as u32, rows as u32], rgb });
    }
}

/// Writes pixels as a PNG file.
pub(super) fn png_file(out: impl io::Write, size: [u32; 2], rgb: &[u8]) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, size[0], size[1]);
    encoder.set_compression(png::Compression::High);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels, three bytes each, in rows.
    fn rows(canvas: Canvas) -> Vec<Vec<u8>> {
        let row = 3 * canvas.pixels.width() as usize;
        canvas.finish().0.chunks_exact(row).map(<[u8]>::to_vec).collect()
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
        canvas.cells([0.0, 0.0, 4.0, 1.0], 12, &[0, 90, 180].map(grey).repeat(4));
        canvas.cells([0.0, 1.0, 4.0, 3.0], 2, &[grey(10), grey(200)]);
        let rows = rows(canvas);
        assert_eq!(red(&rows[0]), [90; 4]);
        assert_eq!(red(&rows[2]), [10, 10, 200, 200]);
    }
}
