//! The 256 colours of a GIF.

use std::collections::HashMap;

use crate::plot::{COLORS, Color, ColorScale};

/// One set of colours for all frames, so that none flickers: the colour scale of maps, greys, and the colours of curves
/// with their antialiased edges towards white.
#[derive(Debug)]
pub(super) struct Palette {
    colors: Vec<Color>,
    /// Nearest entries found before.
    nearest: HashMap<Color, u8>,
}

impl Palette {
    pub(super) fn new(scale: ColorScale) -> Palette {
        let scale = (0..160).map(|k| scale.color(f64::from(2 * k) / 159.0 - 1.0, [-1.0, 1.0]));
        let greys = (0..54).map(|k| (f64::from(k) * 255.0 / 53.0).round() as u8).map(|grey| Color(grey, grey, grey));
        let towards_white = |color: Color, sevenths: u32| {
            let mix = |channel: u8| (255 - (255 - u32::from(channel)) * sevenths / 7) as u8;
            Color(mix(color.0), mix(color.1), mix(color.2))
        };
        let curves = COLORS[..6].iter().flat_map(|&color| (1..=7).map(move |sevenths| towards_white(color, sevenths)));
        Palette { colors: scale.chain(greys).chain(curves).collect(), nearest: HashMap::new() }
    }

    /// Red, green and blue of every colour.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.colors.iter().flat_map(|color| [color.0, color.1, color.2]).collect()
    }

    /// Index of the nearest colour for every pixel.
    pub(super) fn indexed(&mut self, rgb: &[u8]) -> Vec<u8> {
        let colors = &self.colors;
        let nearest = |color: &Color| {
            let distance = |other: &Color| {
                let square = |a: u8, b: u8| (i32::from(a) - i32::from(b)).pow(2);
                square(color.0, other.0) + square(color.1, other.1) + square(color.2, other.2)
            };
            (0..=u8::MAX).zip(colors).min_by_key(|(_, other)| distance(other)).map_or(0, |(k, _)| k)
        };
        let pixels = rgb.chunks_exact(3).map(|pixel| Color(pixel[0], pixel[1], pixel[2]));
        pixels.map(|color| *self.nearest.entry(color).or_insert_with_key(nearest)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_the_palette_are_kept() {
        let mut palette = Palette::new(ColorScale::Sequential);
        assert_eq!(palette.colors.len(), 256);
        for color in COLORS.into_iter().chain([Color::WHITE, Color::BLACK, Color::on_scale(0.0), Color::on_scale(1.0)])
        {
            let index = palette.indexed(&[color.0, color.1, color.2])[0];
            assert_eq!(palette.colors[index as usize], color);
        }
        // every colour of the scale is met within one step
        for k in 0..1000 {
            let color = Color::on_scale(f64::from(k) / 999.0);
            let index = palette.indexed(&[color.0, color.1, color.2])[0];
            let Color(r, g, b) = palette.colors[usize::from(index)];
            assert!(r.abs_diff(color.0) <= 2 && g.abs_diff(color.1) <= 2 && b.abs_diff(color.2) <= 2);
        }
    }
}
