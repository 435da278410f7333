//! Shapes, drawn by plotters as pixels.

use std::fmt::Display;

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::{Color as _, RGBColor, ShapeStyle};

use crate::error::{Error, Result};
use crate::plot::{Color, font};

/// Coordinates of shapes are whole parts of pixels, of which a pixel has so many along each side. Pixels are averages
/// of their parts: edges are smooth although plotters draws at whole coordinates.
pub(super) const FINE: u32 = 4;

/// A point, or two opposite corners, in parts of pixels.
pub(super) type Point = (i32, i32);

/// Which point of a text is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// What pictures consist of; lengths are in parts of pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Shape {
    Line { points: Vec<Point>, width: u32, color: Color },
    Dot { center: Point, radius: u32, color: Color },
    Polygon { corners: Vec<Point>, color: Color },
    Rectangle { corners: [Point; 2], color: Color, percent: u8 },
    Cells { corners: [Point; 2], columns: usize, colors: Vec<Color> },
    Text { text: String, at: Point, size: u32, anchor: Anchor, upright: bool },
}

/// The pixels of a picture.
///
/// # Errors
/// If the backend fails, which is not expected.
pub(super) fn pixels(size: [u32; 2], shapes: &[Shape]) -> Result<Vec<u8>> {
    let [width, height] = size.map(|side| side * FINE);
    let fine = FINE as usize;
    let mut parts = vec![255; 3 * width as usize * height as usize];
    let mut backend = BitMapBackend::with_buffer(&mut parts, (width, height));
    shapes.iter().try_for_each(|shape| shape.draw(&mut backend, 0))?;
    drop(backend);
    let row_of_pixels = |rows: &[u8]| {
        let mut sums = vec![[0_usize; 3]; size[0] as usize];
        for row in rows.chunks_exact(3 * width as usize) {
            for (sum, parts) in sums.iter_mut().zip(row.chunks_exact(3 * fine)) {
                for part in parts.chunks_exact(3) {
                    (0..3).for_each(|c| sum[c] += usize::from(part[c]));
                }
            }
        }
        sums.into_iter().flatten().map(move |sum| (sum / (fine * fine)) as u8)
    };
    Ok(parts.chunks_exact(3 * fine * width as usize).flat_map(row_of_pixels).collect())
}

pub(super) fn failed(error: impl Display) -> Error {
    crate::file::failed("a picture".as_ref(), std::io::Error::other(error.to_string()))
}

pub(super) fn fill(Color(red, green, blue): Color) -> ShapeStyle {
    RGBColor(red, green, blue).filled()
}

impl Shape {
    pub(super) fn draw(&self, target: &mut impl Target, left: i32) -> Result<()> {
        let moved = |(x, y): Point| (x + left, y);
        match self {
            Shape::Line { points, width, color } => {
                let points: Vec<Point> = points.iter().copied().map(moved).collect();
                target.line(&points, fill(*color).stroke_width(*width))
            }
            Shape::Dot { center, radius, color } => {
                target.draw_circle(moved(*center), *radius, &fill(*color), true).map_err(failed)
            }
            Shape::Polygon { corners, color } => {
                target.fill_polygon(corners.iter().copied().map(moved), &fill(*color)).map_err(failed)
            }
            Shape::Rectangle { corners, color, percent } => {
                let [from, to] = corners.map(moved);
                let Color(red, green, blue) = *color;
                let style = RGBColor(red, green, blue).mix(f64::from(*percent) / 100.0);
                target.draw_rect(from, to, &style.filled(), true).map_err(failed)
            }
            Shape::Cells { corners, columns, colors } => {
                let [(left, top), (right, bottom)] = corners.map(moved);
                let edge = |low: i32, high: i32, k: usize, cells: usize| {
                    low + (f64::from(high - low) * k as f64 / cells as f64).round() as i32
                };
                for (j, row) in colors.chunks_exact(*columns).enumerate() {
                    let [above, below] = [j, j + 1].map(|j| edge(top, bottom, j, colors.len() / columns));
                    let mut i = 0;
                    for run in row.chunk_by(|a, b| a == b) {
                        let [from, to] = [i, i + run.len()].map(|i| edge(left, right, i, *columns));
                        target.draw_rect((from, above), (to, below), &fill(run[0]), true).map_err(failed)?;
                        i += run.len();
                    }
                }
                Ok(())
            }
            Shape::Text { text, at, size, anchor, upright } => target.text(text, moved(*at), *size, *anchor, *upright),
        }
    }
}

/// A backend, and what it does not draw as pictures need it.
pub(super) trait Target: DrawingBackend {
    fn line(&mut self, points: &[Point], style: ShapeStyle) -> Result<()>;
    fn text(&mut self, text: &str, at: Point, size: u32, anchor: Anchor, upright: bool) -> Result<()>;
}

impl Target for BitMapBackend<'_> {
    /// Draws pieces and joints: a path of plotters has spikes where it turns back.
    fn line(&mut self, points: &[Point], style: ShapeStyle) -> Result<()> {
        let (width, style) = (style.stroke_width, style.stroke_width(1));
        points.iter().try_for_each(|&at| self.draw_circle(at, (width - 1) / 2, &style, true)).map_err(failed)?;
        for ends in points.windows(2).filter(|ends| ends[0] != ends[1]) {
            self.fill_polygon(piece([ends[0], ends[1]], f64::from(width)), &style).map_err(failed)?;
        }
        Ok(())
    }

    /// Draws with the compiled-in font: plotters places letters unevenly.
    fn text(&mut self, text: &str, at: Point, size: u32, anchor: Anchor, upright: bool) -> Result<()> {
        let size = f64::from(size);
        let shift = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * font::width(text, size),
            Anchor::End => -font::width(text, size),
        };
        let shift = shift.round() as i32;
        let black = RGBColor(0, 0, 0).to_backend_color();
        let mut drawn = Ok(());
        let mut ink = |x: i32, y: i32| {
            let [x, y] = if upright { [y, -(x + shift) - 1] } else { [x + shift, y] };
            drawn = self.draw_pixel((at.0 + x, at.1 + y), black).map_err(failed);
        };
        font::draw(text, size, Some(&mut ink));
        drawn
    }
}

/// The corners of a straight line, rounded so that its width is kept in every direction. Plotters fills the parts of
/// pixels at both ends of a span.
fn piece([from, to]: [Point; 2], width: f64) -> [Point; 4] {
    let along = [to.0 - from.0, to.1 - from.1].map(f64::from);
    let length = along[0].hypot(along[1]);
    let normal = [-along[1] / length, along[0] / length];
    let half = 0.5 * (width - normal[0].abs().max(normal[1].abs()));
    let corner = |end: Point, side: f64| {
        let [x, y] =
            [f64::from(end.0) - 0.5 + side * half * normal[0], f64::from(end.1) - 0.5 + side * half * normal[1]];
        let near = [(x.ceil(), y.ceil()), (x.floor(), y.ceil()), (x.ceil(), y.floor()), (x.floor(), y.floor())];
        let off = |at: &(f64, f64)| ((at.0 - x) * normal[0] + (at.1 - y) * normal[1]).abs();
        near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).map_or(end, |(x, y)| (x as i32, y as i32))
    };
    [corner(from, 1.0), corner(to, 1.0), corner(to, -1.0), corner(from, -1.0)]
}
