//! Colours that can be distinguished without colour vision.

use std::fmt;

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

    /// The colour at the fraction `value` of a scale from 0 to 1; values outside have the colour of the nearer end. The
    /// scale is viridis (van der Walt & Smith, 2015): from dark to light, perceptually uniform and legible without
    /// colour vision.
    pub(super) fn on_scale(value: f64) -> Color {
        let at = value.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
        let [lower, upper] = [at.floor(), at.ceil()].map(|k| VIRIDIS[k as usize]);
        let share = at.ceil() - at;
        let mix = |low: u8, high: u8| ((1.0 - share) * f64::from(high) + share * f64::from(low)).round() as u8;
        Color(mix(lower.0, upper.0), mix(lower.1, upper.1), mix(lower.2, upper.2))
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
