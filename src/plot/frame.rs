//! The frame of charts and maps: axes, grid and labels around an area.

use crate::plot::{Anchor, Canvas, Color, DrawnAxis, TICK_SIZE};

/// Sizes of the labels of axes and of titles in pixels per em.
pub(super) const LABEL_SIZE: f64 = 27.0;
pub(super) const TITLE_SIZE: f64 = 29.0;
/// Length of the ticks, and the distance from there to the numbers, in pixels.
const TICK: f64 = 8.0;
const GAP: f64 = 6.0;
/// Distance from the edge of a picture to the labels in pixels.
const EDGE: f64 = 10.0;
/// Length by which title and label may exceed a frame, half of it at each end, in pixels.
const BESIDE: f64 = 40.0;
/// Height of the numbers and the label below a frame in pixels.
pub(super) const BELOW: f64 = 85.0;

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
    (EDGE + LABEL_SIZE + 2.0 * GAP + axis.widest() + GAP + TICK).ceil()
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
            let ticks = axis.ticks.iter().map(|tick| (tick.0, TICK));
            for (at, length) in ticks.chain(axis.minor.iter().map(|&at| (at, 0.5 * TICK))) {
                let [x, y] = self.place(at * place[0], at * place[1]);
                lines.push(vec![[x, y], [x - length * place[1], y + length * place[0]]]);
            }
        }
        // on whole pixels, so that no line is spread over three rows
        lines.iter_mut().flatten().flatten().for_each(|value| *value = value.round());
        canvas.lines(&lines, 2.0, Color::BLACK);
        for (at, text) in &x.ticks {
            let at = [self.place(*at, 0.0)[0], bottom + TICK + GAP + 0.75 * TICK_SIZE];
            canvas.text(text, at, TICK_SIZE, Anchor::Middle, false);
        }
        for (at, text) in &y.ticks {
            let at = [left - TICK - GAP, self.place(0.0, *at)[1] + 0.35 * TICK_SIZE];
            canvas.text(text, at, TICK_SIZE, Anchor::End, false);
        }
        let below = bottom + TICK + GAP + TICK_SIZE + GAP + LABEL_SIZE;
        canvas.fitted_text(&x.label, [middle[0], below], LABEL_SIZE, right - left + BESIDE, false);
        canvas.fitted_text(&y.label, [EDGE + 0.8 * LABEL_SIZE, middle[1]], LABEL_SIZE, bottom - top + 60.0, true);
        canvas.fitted_text(title, [middle[0], top - 18.0], TITLE_SIZE, right - left + BESIDE, false);
    }
}
