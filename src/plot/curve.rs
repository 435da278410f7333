//! A curve of a chart.

use crate::plot::sizes::SIZES;
use crate::plot::{Canvas, Color};

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Style {
    /// A line through its points.
    Line,
    /// A dot at each point.
    Dots,
    /// Both.
    LineAndDots,
}

/// Preferred position of the legend in a chart. It stands elsewhere if it hides less of the curves there; the
/// vertical axis becomes longer where no position is free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are self-explanatory")]
#[expect(clippy::exhaustive_enums, reason = "there are nine positions")]
pub enum Legend {
    UpperLeft,
    UpperMiddle,
    UpperRight,
    MiddleLeft,
    MiddleMiddle,
    MiddleRight,
    LowerLeft,
    LowerMiddle,
    LowerRight,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    pub(super) label: String,
    pub(super) points: Vec<(f64, f64)>,
    pub(super) color: Color,
    pub(super) style: Style,
}

impl Style {
    /// Draws a curve through `pieces` with dots at `dots`.
    pub(super) fn draw(self, canvas: &mut Canvas, pieces: &[Vec<[f64; 2]>], dots: &[[f64; 2]], color: Color) {
        if self != Style::Dots {
            canvas.lines(pieces, SIZES.line, color);
        }
        if self != Style::Line {
            canvas.dots(dots, SIZES.dot, color);
        }
    }
}
