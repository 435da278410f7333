//! The load within a step, looked at densely.

use crate::error::Result;
use crate::run::trace::ROUNDING;

/// Number of parts of a step at whose ends its load is looked at, of even number: the middle is one of them.
const PARTS: usize = 64;
/// The others are uneven by so much of a part, so that no oscillation is zero at all of them.
const UNEVEN: f64 = 0.4;
/// The golden ratio spreads multiples evenly.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// An event so early in a step, as a part of it, happens at its start.
pub(crate) const AT_START: f64 = 1e-3;

/// Start and end of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) now: f64,
    pub(crate) end: f64,
}

/// The load at times of a step in ascending order, from its start to its end: force, or depth of
/// the load point or of the far end of its spring. Each maximum and minimum of the others is among
/// them as well.
#[derive(Debug, Clone, Default)]
pub(crate) struct Passage {
    pub(crate) points: Vec<(f64, f64)>,
    /// The load at the start, in the middle and at the end.
    pub(crate) marks: [f64; 3],
    /// Where they are collected.
    seen: Vec<(f64, f64)>,
}

impl Passage {
    /// Makes room for steps of a run whose load bends so many times: no step allocates.
    pub(crate) fn reserve(&mut self, bends: usize) {
        let most = bends + PARTS + 1;
        self.seen.reserve(most);
        self.points.reserve(2 * most);
    }

    /// Looks at the load within a step that begins with a load of this size, at parts of the step and at those of the
    /// ascending `times` that lie within it.
    pub(crate) fn look(
        &mut self,
        Span { now, end }: Span,
        first: f64,
        times: &[f64],
        mut load: impl FnMut(f64) -> Result<f64>,
    ) -> Result<()> {
        let mut others = times[times.partition_point(|time| *time <= now)..].iter().copied().peekable();
        self.seen.clear();
        self.points.clear();
        self.seen.push((now, first));
        self.marks[1] = f64::NAN;
        for k in 1..=PARTS {
            let uneven = if k % (PARTS / 2) == 0 { 0.0 } else { UNEVEN * (k as f64 * GOLDEN).fract() };
            let time = if k == PARTS { end } else { now + (end - now) * (k as f64 - uneven) / PARTS as f64 };
            while let Some(other) = others.next_if(|other| *other < time) {
                self.seen.push((other, load(other)?));
            }
            // parts of a step of a few digits of time are rounded to its ends, where the load may jump
            if k < PARTS && !(now < time && time < end) {
                continue;
            }
            others.next_if_eq(&time);
            let value = load(time)?;
            self.seen.push((time, value));
            if k == PARTS / 2 {
                self.marks[1] = value;
            }
        }
        let last = self.seen[self.seen.len() - 1].1;
        let middle = if self.marks[1].is_nan() { 0.5 * (first + last) } else { self.marks[1] };
        self.marks = [first, middle, last];
        self.points.push(self.seen[0]);
        for three in self.seen.windows(3) {
            let [a, b, c] = [three[0], three[1], three[2]];
            let turn = if (b.1 - a.1) * (b.1 - c.1) > 0.0 { vertex([a, b, c]) } else { b.0 };
            let turn = if a.0 < turn && turn < c.0 && turn != b.0 { Some((turn, load(turn)?)) } else { None };
            self.points.extend(turn.filter(|turn| turn.0 < b.0));
            self.points.push(b);
            self.points.extend(turn.filter(|turn| turn.0 > b.0));
        }
        self.points.extend(self.seen.last());
        Ok(())
    }

    /// Maximum load.
    pub(crate) fn top(&self) -> f64 {
        self.points.iter().fold(f64::NEG_INFINITY, |most, point| point.1.max(most))
    }

    /// Looks at loads that were seen before.
    pub(crate) fn show(&mut self, seen: &[(f64, f64)]) {
        self.points.clear();
        self.points.extend_from_slice(seen);
    }

    /// Loads within the step, apart from its ends, and their times.
    pub(crate) fn inside(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points[1..].iter().copied().take(self.points.len().saturating_sub(2))
    }

    /// Times within the step at which the load turns, as far as this is not its rounding, and whether it is at a top.
    pub(crate) fn turns(&self) -> impl Iterator<Item = (f64, bool)> {
        let size = self.points.iter().fold(0.0, |most: f64, point| most.max(point.1.abs()));
        let (mut last, mut rises) = (self.points.first().copied(), None);
        self.points.iter().filter_map(move |point| {
            let change = point.1 - last.map_or(point.1, |last| last.1);
            if change.abs() <= ROUNDING * size {
                return None;
            }
            let turn = last.replace(*point).filter(|_| rises.is_some_and(|rises| rises != (change > 0.0)));
            rises = Some(change > 0.0);
            turn.map(|turn| (turn.0, change < 0.0))
        })
    }

    /// The first top of the load within the step.
    pub(crate) fn first_top(&self) -> Option<f64> {
        self.turns().find(|turn| turn.1).map(|turn| turn.0)
    }

    /// Maximum deviation of the load from the parabola through the start, the middle and the end of
    /// the step. How far apart bodies are does not matter where this is more than `size`, the
    /// maximum load.
    pub(crate) fn bend(&self, size: f64) -> f64 {
        let near = |load: f64| load.max(-size);
        let ([a, b, c], Span { now, end }) = (self.marks.map(near), self.span());
        let off = |&(time, load): &(f64, f64)| {
            let s = (time - now) / (end - now);
            let parabola = a * (1.0 - s) * (1.0 - 2.0 * s) + 4.0 * b * s * (1.0 - s) + c * s * (2.0 * s - 1.0);
            (near(load) - parabola).abs()
        };
        self.points.iter().map(off).fold(0.0, f64::max)
    }

    pub(crate) fn span(&self) -> Span {
        let [first, .., last] = self.points[..] else { return Span { now: 0.0, end: 0.0 } };
        Span { now: first.0, end: last.0 }
    }
}

/// The time at which the parabola through three points turns.
fn vertex([a, b, c]: [(f64, f64); 3]) -> f64 {
    let [left, right] = [(b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0)];
    0.5 * (a.0 + b.0) + 0.5 * (c.0 - a.0) * left / (left - right)
}
