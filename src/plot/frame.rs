//! The frame of charts and maps: axes, grid and labels around an area.

use crate::plot::sizes::SIZES;
use crate::plot::{Anchor, Canvas, Color, DrawnAxis};

/// An area with a horizontal and a vertical axis, in pixels from the upper left corner of the picture.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    pub(super) axes: [DrawnAxis; 2],
}

/// Width that numbers and label need to the left of a frame in pixels.
pub(super) fn width_beside(axis: &DrawnAxis) -> f64 {
    (SIZES.edge + SIZES.label + 2.0 * SIZES.to_numbers + axis.widest() + SIZES.to_numbers + SIZES.tick).ceil()
}

impl Frame {
    /// Where a point of fractions of the axes lies.
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        [self.left + x * (self.right - self.left), self.bottom - y * (self.bottom - self.top)]
    }

    /// Where a point in SI lies.
    pub(super) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        self.place(self.axes[0].fraction(x), self.axes[1].fraction(y))
    }

    /// Quiet lines at the numbers.
    pub(super) fn draw_grid(&self, canvas: &mut Canvas) {
        let across = self.axes[1].ticks.iter().map(|&(y, _)| [self.place(0.0, y), self.place(1.0, y)]);
        let up = self.axes[0].ticks.iter().map(|&(x, _)| [self.place(x, 0.0), self.place(x, 1.0)]);
        let lines = across.chain(up).map(|line| line.map(|point| point.map(|value| value.floor() + 0.5)).to_vec());
        canvas.lines(&lines.collect::<Vec<_>>(), 1.0, Color(226, 226, 226));
    }

    /// The frame with ticks, numbers, labels and a title.
    pub(super) fn draw(&self, canvas: &mut Canvas, title: &str) {
        let Frame { left, top, right, bottom, axes: [x, y] } = self;
        let (left, top, right, bottom) = (*left, *top, *right, *bottom);
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        let corners = [[left, top], [left, bottom], [right, bottom], [right, top], [left, top]];
        let mut lines = vec![corners.to_vec()];
        for (axis, place) in [(x, [1.0, 0.0]), (y, [0.0, 1.0])] {
            let ticks = axis.ticks.iter().map(|tick| (tick.0, SIZES.tick));
            for (at, length) in ticks.chain(axis.minor.iter().map(|&at| (at, 0.5 * SIZES.tick))) {
                let [x, y] = self.place(at * place[0], at * place[1]);
                lines.push(vec![[x, y], [x - length * place[1], y + length * place[0]]]);
            }
        }
        // on whole pixels, so that no line is spread over three rows
        lines.iter_mut().flatten().flatten().for_each(|value| *value = value.round());
        canvas.lines(&lines, 2.0, Color::BLACK);
        for (at, text) in &x.ticks {
            let at = [self.place(*at, 0.0)[0], bottom + SIZES.tick + SIZES.to_numbers + 0.75 * SIZES.numbers];
            canvas.text(text, at, SIZES.numbers, Anchor::Middle, false);
        }
        for (at, text) in &y.ticks {
            let at = [left - SIZES.tick - SIZES.to_numbers, self.place(0.0, *at)[1] + 0.35 * SIZES.numbers];
            canvas.text(text, at, SIZES.numbers, Anchor::End, false);
        }
        let below = bottom + SIZES.tick + SIZES.to_numbers + SIZES.numbers + SIZES.to_numbers + SIZES.label;
        canvas.fitted_text(&x.label, [middle[0], below], SIZES.label, right - left + SIZES.title_beyond, false);
        canvas.fitted_text(
            &y.label,
            [SIZES.edge + 0.8 * SIZES.label, middle[1]],
            SIZES.label,
            bottom - top + 60.0,
            true,
        );
        canvas.fitted_text(title, [middle[0], top - 18.0], SIZES.title, right - left + SIZES.title_beyond, false);
    }
}
