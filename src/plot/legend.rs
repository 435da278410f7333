//! The legend of a chart, and where it hides least.

use crate::plot::curve::Curve;
use crate::plot::sizes::SIZES;
use crate::plot::{Anchor, Canvas, Color, Frame, Legend, font};

/// All positions, corners first: rows of three from the top, each from the left.
const ALL: [usize; 9] = [2, 0, 8, 6, 1, 7, 5, 3, 4];

impl Legend {
    /// The rectangle of a legend of this size at a position: left, top, right and bottom.
    fn rectangle(position: usize, size: [f64; 2], frame: &Frame) -> [f64; 4] {
        let [width, height] = size;
        let (row, column) = (position / 3, position % 3);
        let start = |low: f64, high: f64, size: f64| {
            [low + SIZES.legend_inset, 0.5 * (low + high - size), high - SIZES.legend_inset - size]
        };
        let left = start(frame.left, frame.right, width)[column];
        let top = start(frame.top, frame.bottom, height)[row];
        [left, top, left + width, top + height].map(f64::round)
    }

    /// The rectangle of a legend that covers the fewest of `points`, and how many; at this position if no other covers
    /// fewer.
    fn place(self, size: [f64; 2], frame: &Frame, points: &[[f64; 2]]) -> ([f64; 4], usize) {
        let covered = |[left, top, right, bottom]: [f64; 4]| {
            let near = |low: f64, high: f64, value: f64| (low - 6.0..=high + 6.0).contains(&value);
            points.iter().filter(|[x, y]| near(left, right, *x) && near(top, bottom, *y)).count()
        };
        let positions =
            std::iter::once(self as usize).chain(ALL).map(|position| Legend::rectangle(position, size, frame));
        let counted = positions.map(|rectangle| (rectangle, covered(rectangle)));
        counted.min_by_key(|(_, covered)| *covered).unwrap_or_default()
    }
}

/// Points along a line, close enough that none passes under a legend unseen.
pub(super) fn points_along(line: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    line.windows(2).flat_map(|ends| {
        let [dx, dy] = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
        let count = (dx.hypot(dy) / SIZES.curve_points).ceil().max(1.0);
        (0..=count as usize).map(move |k| {
            let t = k as f64 / count;
            [ends[0][0] + t * dx, ends[0][1] + t * dy]
        })
    })
}

/// Width and height of a legend.
fn size(entries: &[&Curve]) -> [f64; 2] {
    let widest = entries.iter().map(|entry| font::width(&entry.label, SIZES.numbers)).fold(0.0, f64::max);
    [3.0 * SIZES.around_entries + SIZES.entry_line + widest, SIZES.around_entries + SIZES.entry * entries.len() as f64]
}

/// How many of `points` the legend would cover.
pub(super) fn covered(entries: &[&Curve], preferred: Legend, frame: &Frame, points: &[[f64; 2]]) -> usize {
    if entries.is_empty() { 0 } else { preferred.place(size(entries), frame, points).1 }
}

/// Draws the entries where they cover the fewest of `points`.
pub(super) fn draw(canvas: &mut Canvas, entries: &[&Curve], preferred: Legend, frame: &Frame, points: &[[f64; 2]]) {
    if entries.is_empty() {
        return;
    }
    let (area @ [left, top, right, bottom], _) = preferred.place(size(entries), frame, points);
    canvas.rectangle(area, Color::WHITE, 85);
    let outline = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
    canvas.lines(&[outline.map(|point| point.map(|value| value + 0.5)).to_vec()], 1.0, Color(190, 190, 190));
    for (k, Curve { label, color, style, .. }) in entries.iter().enumerate() {
        let (x, y) = (left + SIZES.around_entries, top + 0.5 * SIZES.around_entries + SIZES.entry * (k as f64 + 0.5));
        style.draw(canvas, &[vec![[x, y], [x + SIZES.entry_line, y]]], &[[x + 0.5 * SIZES.entry_line, y]], *color);
        canvas.text(
            label,
            [x + SIZES.entry_line + SIZES.around_entries, y + 0.35 * SIZES.numbers],
            SIZES.numbers,
            Anchor::Start,
            false,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::axis::{DrawnAxis, Room};

    #[test]
    fn the_legend_avoids_the_data() {
        let axis = |horizontal| DrawnAxis::linear(&"q".into(), 1.0, [0.0, 1.0], Room { length: 600.0, horizontal });
        let frame = Frame { left: 100.0, top: 50.0, right: 1100.0, bottom: 650.0, axes: [axis(true), axis(false)] };
        let size = [300.0, 100.0];
        let line = |from: [f64; 2], to: [f64; 2]| points_along(&[from, to]).collect::<Vec<_>>();
        let rising = line([100.0, 650.0], [1100.0, 50.0]);
        let at = |legend: Legend| Legend::rectangle(legend as usize, size, &frame);
        // where it is wanted, as long as it hides nothing there
        assert_eq!(Legend::UpperLeft.place(size, &frame, &rising).0, at(Legend::UpperLeft));
        assert_eq!(Legend::LowerRight.place(size, &frame, &rising).0, at(Legend::LowerRight));
        assert_eq!(Legend::UpperRight.place(size, &frame, &rising).0, at(Legend::UpperLeft));
        let both = [rising, line([100.0, 50.0], [1100.0, 650.0])].concat();
        assert_eq!(Legend::UpperLeft.place(size, &frame, &both).0, at(Legend::UpperMiddle));
        // two far ends of a line: what passes between them counts
        let under_top = line([100.0, 100.0], [1100.0, 100.0]);
        assert_eq!(Legend::UpperMiddle.place(size, &frame, &under_top).0, at(Legend::LowerRight));
    }
    #[test]
    fn a_chart_grows_until_the_legend_hides_nothing() {
        use crate::plot::{COLORS, Chart, Style};
        let blue = |label: &str| {
            let mut chart = Chart::new("", "x", "y", Legend::UpperRight);
            // zigzags through all positions
            let points = (0..=60).map(|k| (f64::from(k), f64::from(k % 2))).collect();
            chart.add(label, COLORS[0], Style::Line, points);
            let picture = chart.draw().unwrap();
            let width = picture.size()[0] as usize;
            let pixels = picture.rgb().chunks_exact(3).enumerate().filter(|(_, pixel)| *pixel == [0, 114, 178]);
            pixels.filter(|(k, _)| k % width < 800).map(|(k, _)| k / width).min().unwrap()
        };
        // the curve, left of the legend, ends lower
        assert!(blue("") < 90 && (120..200).contains(&blue("zigzag")), "{} {}", blue(""), blue("zigzag"));
    }
}
