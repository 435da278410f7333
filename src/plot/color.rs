//! Colours that can be distinguished without colour vision.

use std::fmt;

use crate::output::Field;

/// A colour: red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(clippy::exhaustive_structs, reason = "users construct colours")]
pub struct Color(pub u8, pub u8, pub u8);

/// The palette of Okabe & Ito (*Color Universal Design*, 2008), whose colours readers with any colour vision can
/// distinguish: one colour per curve.
pub const COLORS: [Color; 7] = [
    Color(0, 114, 178),
    Color(213, 94, 0),
    Color(0, 158, 115),
    Color(204, 121, 167),
    Color(230, 159, 0),
    Color(86, 180, 233),
    Color::BLACK,
];

impl Color {
    /// For cells out of contact.
    pub const WHITE: Color = Color(255, 255, 255);
    /// For cells without a value.
    pub const GREY: Color = Color(190, 190, 190);
    /// For text and frames.
    pub const BLACK: Color = Color(0, 0, 0);

    /// The colour of viridis at the fraction `value` from 0 to 1; values outside have the colour of the nearer end.
    pub(super) fn on_scale(value: f64) -> Color {
        Color::between(&VIRIDIS, value)
    }

    /// The colour at the fraction `value` of `colors` at equal distances.
    fn between(colors: &[Color], value: f64) -> Color {
        let at = value.clamp(0.0, 1.0) * (colors.len() - 1) as f64;
        let [lower, upper] = [at.floor(), at.ceil()].map(|k| colors[k as usize]);
        let share = at.ceil() - at;
        let mix = |low: u8, high: u8| ((1.0 - share) * f64::from(high) + share * f64::from(low)).round() as u8;
        Color(mix(lower.0, upper.0), mix(lower.1, upper.1), mix(lower.2, upper.2))
    }
}

/// The colours of a [`Map`](crate::plot::Map). Both scales are legible without colour vision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ColorScale {
    /// From dark to light (viridis, van der Walt & Smith, 2015).
    #[default]
    Sequential,
    /// White at zero, blue below and red above, equally strong at equal distances from zero (ColorBrewer, Harrower &
    /// Brewer, 2003): for fields with a sign.
    Diverging,
}

impl ColorScale {
    /// The scale of a field: tractions have a sign.
    pub(super) fn of(field: Field) -> ColorScale {
        if field == Field::Traction { ColorScale::Diverging } else { ColorScale::Sequential }
    }

    /// The colour of a value on a scale from `low` to `high`; values outside have the colour of the nearer end.
    pub(super) fn color(self, value: f64, [low, high]: [f64; 2]) -> Color {
        match self {
            ColorScale::Sequential => Color::on_scale((value - low) / (high - low)),
            ColorScale::Diverging => {
                Color::between(&BLUE_TO_RED, 0.5 + 0.5 * value.clamp(low, high) / low.abs().max(high.abs()))
            }
        }
    }
}

/// Eight colours of viridis at equal distances; the colours between are interpolated.
const VIRIDIS: [Color; 8] = [
    Color(68, 1, 84),
    Color(70, 50, 127),
    Color(54, 92, 141),
    Color(39, 127, 143),
    Color(31, 162, 136),
    Color(74, 194, 110),
    Color(160, 219, 57),
    Color(254, 232, 37),
];

/// Eleven colours of ColorBrewer's `RdBu` from blue to red, white in the middle.
const BLUE_TO_RED: [Color; 11] = [
    Color(5, 48, 97),
    Color(33, 102, 172),
    Color(67, 147, 195),
    Color(146, 197, 222),
    Color(209, 229, 240),
    Color(247, 247, 247),
    Color(253, 219, 199),
    Color(244, 165, 130),
    Color(214, 96, 77),
    Color(178, 24, 43),
    Color(103, 0, 31),
];

/// The colour in hexadecimal digits, as in HTML.
impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_brightens_evenly_from_end_to_end() {
        let brightness = |fraction: f64| {
            let Color(r, g, b) = Color::on_scale(fraction);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert_eq!(Color::on_scale(0.0), Color(68, 1, 84));
        assert_eq!(Color::on_scale(1.0), Color(254, 232, 37));
        for k in 0..64 {
            assert!(brightness(f64::from(k) / 64.0) < brightness(f64::from(k + 1) / 64.0));
        }
        assert_eq!([Color::on_scale(-1.0), Color::on_scale(7.0)], [Color::on_scale(0.0), Color::on_scale(1.0)]);
    }
}
