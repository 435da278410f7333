//! Shapes as an SVG document: plotters writes them, but for cells, which are an image.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontDesc, FontFamily, FontStyle, FontTransform, ShapeStyle, TextStyle};

use crate::error::Result;
use crate::plot::Color;
use crate::plot::canvas::png_file;
use crate::plot::shape::{Anchor, FINE, Point, Shape, Target, failed, fill};

/// The font of the pixels, then fonts that most systems have.
const FONTS: &str = "'Ubuntu Light', Ubuntu, Arial, Helvetica, 'Liberation Sans', sans-serif";

/// The SVG document of pictures that begin at given distances from the left edge.
///
/// # Errors
/// If the backend fails, which is not expected.
pub(super) fn document(size: [u32; 2], pictures: &[(u32, Vec<Shape>)]) -> Result<String> {
    let [width, height] = size.map(|side| side * FINE);
    let mut document = format!(
        "<svg width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\" \
         xmlns:xlink=\"http://www.w3.org/1999/xlink\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n",
        size[0], size[1]
    );
    let corner = (width as i32, height as i32);
    document += &written(|paper| paper.draw_rect((0, 0), corner, &fill(Color::WHITE), true).map_err(failed))?;
    for (left, shapes) in pictures {
        let left = (left * FINE) as i32;
        let is_image = |shape: &Shape| matches!(shape, Shape::Cells { .. });
        for group in shapes.chunk_by(|one, next| !is_image(one) && !is_image(next)) {
            document += &match group {
                [Shape::Cells { corners, columns, colors }] => image(*corners, *columns, colors, left)?,
                _ => written(|backend| group.iter().try_for_each(|shape| shape.draw(backend, left)))?,
            };
        }
    }
    Ok(document + "</svg>\n")
}

/// What plotters writes between the beginning of a document and its end.
fn written(draw: impl FnOnce(&mut SVGBackend<'_>) -> Result<()>) -> Result<String> {
    let mut text = String::new();
    let mut backend = SVGBackend::with_string(&mut text, (1, 1));
    draw(&mut backend)?;
    backend.present().map_err(failed)?;
    drop(backend);
    let inner =
        text.split_once('>').and_then(|(_, rest)| rest.rsplit_once("</svg>")).map(|(inner, _)| inner.trim_start());
    inner.map(str::to_owned).ok_or_else(|| failed("a document of plotters without a beginning and an end"))
}

/// Cells as an image of a pixel each, which viewers do not smooth unless there are more cells than pixels. A map takes what
/// it takes as PNG; rectangles would take a hundred bytes for each cell.
fn image([(left, top), (right, bottom)]: [Point; 2], columns: usize, colors: &[Color], start: i32) -> Result<String> {
    let rows = colors.len() / columns;
    let rgb: Vec<u8> = colors.iter().flat_map(|&Color(red, green, blue)| [red, green, blue]).collect();
    let mut png = Vec::new();
    png_file(&mut png, [columns as u32, rows as u32], &rgb).map_err(failed)?;
    let larger_than_pixels =
        right - left >= (FINE * columns as u32) as i32 && bottom - top >= (FINE * rows as u32) as i32;
    let sharp =
        if larger_than_pixels { " style=\"image-rendering:crisp-edges;image-rendering:pixelated\"" } else { "" };
    Ok(format!(
        "<image x=\"{}\" y=\"{top}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\"{sharp} \
         xlink:href=\"data:image/png;base64,{}\"/>\n",
        left + start,
        right - left,
        bottom - top,
        BASE64_STANDARD.encode(png)
    ))
}

impl Target for SVGBackend<'_> {
    fn line(&mut self, points: &[Point], style: ShapeStyle) -> Result<()> {
        self.draw_path(points.iter().copied(), &style).map_err(failed)
    }

    fn text(&mut self, text: &str, at: Point, size: u32, anchor: Anchor, upright: bool) -> Result<()> {
        let horizontal = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        // plotters writes sizes divided by 1.24, and a top 0.76 em above the baseline
        let font = FontDesc::new(FontFamily::Name(FONTS), 1.24 * f64::from(size), FontStyle::Normal);
        let ascent = (0.76 * f64::from(size)).round() as i32;
        let (font, at) = if upright {
            (font.transform(FontTransform::Rotate270), (at.0 - ascent, at.1))
        } else {
            (font, (at.0, at.1 - ascent))
        };
        let style = TextStyle::from(font).pos(Pos::new(horizontal, VPos::Top));
        self.draw_text(text, &style, at).map_err(failed)
    }
}
