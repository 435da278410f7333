//! The compiled-in font: widths of texts, and the pixels of their letters.

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, PxScaleFont, ScaleFont as _, point};

use crate::error::Result;
use crate::file::failed;

/// The font of all texts: no system font is needed.
static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).ok());

/// # Errors
/// If the font cannot be read.
pub(super) fn check() -> Result<()> {
    let error = || failed("a picture".as_ref(), std::io::Error::other("the font cannot be read"));
    FONT.as_ref().map(drop).ok_or_else(error)
}

/// Width of a text of `size` pixels per em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    draw(text, size, [0.0; 2], &mut |_, _, _| {})
}

/// Calls `ink` with every pixel of a text whose baseline starts at a point, and the share of the pixel that is covered;
/// returns the width of the text.
pub(super) fn draw(text: &str, size: f64, start: [f64; 2], ink: &mut dyn FnMut(i32, i32, f32)) -> f64 {
    let [x, y] = start;
    let mut left = x as f32;
    for c in text.chars() {
        // the font lacks the superscript minus: a small raised one replaces it
        let (c, factor, raised) = if c == '⁻' { ('−', 0.62, 0.29) } else { (c, 1.0, 0.0) };
        let Some(font) = scaled(factor * size) else { break };
        let mut glyph = font.scaled_glyph(c);
        let advance = font.h_advance(glyph.id);
        glyph.position = point(left, (y - raised * size) as f32);
        if let Some(outline) = font.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|i, j, covered| ink(corner.x as i32 + i as i32, corner.y as i32 + j as i32, covered.min(1.0)));
        }
        left += advance;
    }
    f64::from(left) - x
}

/// The font with `size` pixels per em.
fn scaled(size: f64) -> Option<PxScaleFont<&'static FontRef<'static>>> {
    let font = FONT.as_ref()?;
    Some(font.as_scaled(size as f32 * font.height_unscaled() / font.units_per_em()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glyphs_stand_on_the_baseline_at_their_bearing() {
        check().unwrap();
        let ink = |text: &str| {
            let (mut left, mut right, mut top, mut bottom) = (i32::MAX, i32::MIN, i32::MAX, i32::MIN);
            draw(text, 400.0, [0.0; 2], &mut |x, y, covered| {
                if covered >= 0.5 {
                    (left, right, top, bottom) = (left.min(x), right.max(x + 1), top.min(y), bottom.max(y + 1));
                }
            });
            [left, right, top, bottom].map(|edge| f64::from(edge) / 4.0)
        };
        let [left, right, top, bottom] = ink("H");
        let wide = width("H", 100.0);
        assert!((left - 9.8).abs() < 1.0 && (wide - right - left).abs() < 1.0, "{left} {right} of {wide}");
        assert!((top + 69.0).abs() < 2.0 && bottom.abs() < 1.0, "{top} {bottom}");
        // the superscript minus lies within the height of a superscript digit
        let [_, _, top, bottom] = ink("⁻");
        let [_, _, digit_top, digit_bottom] = ink("⁴");
        assert!(digit_top < top && bottom < digit_bottom && digit_bottom < -20.0, "{top} {bottom}");
    }
}
