//! Bodies that slide in both halves of a step, and stick before its end: neither the halves nor the whole see it.

use crate::run::passage::Span;

/// Looks at what moves a body, within the second half of a step: it deviates from a parabola by little in a step, and
/// three neighbours are followed by one, so that the maximum is off by the third power of their distance.
const LOOKS: u32 = 16;

/// How far a body that slides by so much in the halves of a step would turn back from its maximum in the second one, moved
/// by a `drive` of the time, which it follows but for what it creeps, a quadratic of time. It cannot: it sticks.
pub(crate) fn turned_back(slid: [f64; 2], Span { now, end }: Span, drive: impl Fn(f64) -> f64) -> f64 {
    let [first, last] = slid;
    // what slides in the second half alone, or back, differs in the whole
    if first == 0.0 || first * last < 0.0 {
        return 0.0;
    }
    let (half, driven) = (0.5 * (end - now), drive(end));
    let middle = drive(now + half);
    let [before, after] = [middle - drive(now) - first, driven - middle - last];
    // what it slides from so many halves before the end on
    let left = |back: f64| {
        let creeps = back * (after + 0.5 * (before - after) * (back - 1.0));
        (driven - drive(end - back * half) - creeps) * first.signum()
    };
    let at = |look: u32| left(f64::from(look) / f64::from(LOOKS));
    let least = (1..LOOKS).map(|look| (at(look), look)).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((least, look)) = least else { return 0.0 };
    // of the parabola through it and its neighbours
    let [sooner, later] = [at(look + 1), at(look - 1)];
    let (slope, bend) = (0.5 * (later - sooner), sooner - 2.0 * least + later);
    let fall = if slope.abs() < bend { 0.5 * slope * slope / bend } else { 0.0 };
    (fall - least).max(0.0)
}
