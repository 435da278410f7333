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
    pub(super) const WHITE: Color = Color(255, 255, 255);
    /// For cells without a value.
    pub(super) const GREY: Color = Color(190, 190, 190);
    /// For text and frames.
    pub(super) const BLACK: Color = Color(0, 0, 0);

    /// The colour of viridis at the fraction `value` from 0 to 1; values outside have the colour of the nearer end.
    pub(super) fn on_scale(value: f64) -> Color {
        Color::between(&VIRIDIS, value)
    }

    /// The colour at the fraction `value` of `colors` at equal distances.
    fn between(colors: &[u32], value: f64) -> Color {
        let at = value.clamp(0.0, 1.0) * (colors.len() - 1) as f64;
        let [lower, upper] = [at.floor(), at.ceil()].map(|k| colors[k as usize].to_be_bytes());
        let share = at.ceil() - at;
        let mix = |k: usize| ((1.0 - share) * f64::from(upper[k]) + share * f64::from(lower[k])).round() as u8;
        Color(mix(1), mix(2), mix(3))
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
const VIRIDIS: [u32; 8] = [0x44_0154, 0x46_327f, 0x36_5c8d, 0x27_7f8f, 0x1f_a288, 0x4a_c26e, 0xa0_db39, 0xfe_e825];

/// Eleven colours of ColorBrewer's `RdBu` from blue to red, white in the middle.
const BLUE_TO_RED: [u32; 11] = [
    0x05_3061, 0x21_66ac, 0x43_93c3, 0x92_c5de, 0xd1_e5f0, 0xf7_f7f7, 0xfd_dbc7, 0xf4_a582, 0xd6_604d, 0xb2_182b,
    0x67_001f,
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
