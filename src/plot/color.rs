//! Colours that are told apart without colour vision.

use plotters::style::RGBColor;

/// A colour: red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(clippy::exhaustive_structs, reason = "users write it")]
pub struct Color(pub u8, pub u8, pub u8);

/// Okabe & Ito's palette (*Color Universal Design*, 2008), told apart by colour-blind readers: one colour a series.
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
    /// For cells that do not touch.
    pub const WHITE: Color = Color(255, 255, 255);
    /// For cells where nothing is known.
    pub const GREY: Color = Color(190, 190, 190);
    /// For text and frames.
    pub const BLACK: Color = Color(0, 0, 0);

    /// The colour of the share `value` of a scale, of 0 at its lower and 1 at its upper end; those beyond have the
    /// colour of the end. Light to dark, even in brightness and legible without colour vision: straight lines through
    /// points of the viridis scale (van der Walt & Smith, 2015), reversed.
    pub(super) fn of_share(value: f64) -> Color {
        const POINTS: [[f64; 3]; 5] =
            [[253.0, 231.0, 37.0], [94.0, 201.0, 98.0], [33.0, 145.0, 140.0], [59.0, 82.0, 139.0], [68.0, 1.0, 84.0]];
        let position = value.clamp(0.0, 1.0) * 4.0;
        let k = (position as usize).min(3);
        let mix = |m: usize| (POINTS[k][m] + (position - k as f64) * (POINTS[k + 1][m] - POINTS[k][m])).round() as u8;
        Color(mix(0), mix(1), mix(2))
    }

    pub(super) fn rgb(self) -> RGBColor {
        RGBColor(self.0, self.1, self.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_darkens_evenly_from_end_to_end() {
        let brightness = |share: f64| {
            let Color(r, g, b) = Color::of_share(share);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert_eq!(Color::of_share(0.0), Color(253, 231, 37));
        assert_eq!(Color::of_share(1.0), Color(68, 1, 84));
        for k in 0..64 {
            assert!(brightness(f64::from(k) / 64.0) > brightness(f64::from(k + 1) / 64.0));
        }
        assert_eq!([Color::of_share(-1.0), Color::of_share(7.0)], [Color::of_share(0.0), Color::of_share(1.0)]);
    }
}
