//! The regular positions along an axis on which points lie.

use std::collections::BTreeSet;

use crate::error::{Error, Refusal, Result, least_length, positive};
use crate::rounded::rounded;

/// Maximum distance of a point from the regular grid, in spacings.
const MAX_OFFSET: f64 = 1e-3;
/// Coordinates closer than this fraction of the spacing are the same.
const SAME_POSITION: f64 = 1e-2;

/// The point of a line.
pub(super) struct Point {
    pub(super) line: u64,
    pub(super) at: [f64; 2],
    pub(super) height: f64,
}

/// The error of points that are no regular grid.
pub(super) fn sparse(points: usize, [n1, n2]: [usize; 2]) -> Error {
    let what = format!("{points} points are too few for the regular grid of {n1} x {n2} that their distances suggest");
    Refusal::file("map_sparse", what, ": interpolate scattered points on a regular grid").into()
}

/// The regular positions along an axis of the grid.
pub(super) struct RegularAxis {
    pub(super) cells: usize,
    pub(super) spacing: f64,
    /// Index of each point.
    pub(super) indices: Vec<usize>,
}

/// Determines the regular positions along one axis of the points.
///
/// Coordinates that differ by a small fraction of the spacing are the same, and rows or columns may be absent. So the
/// spacing is near a step that is large beside the next smaller one: the first such step on whose grid the points lie.
pub(super) fn axis(points: &[Point], name: &'static str, axis: usize) -> Result<RegularAxis> {
    let field = if axis == 0 { "different x of the points" } else { "different y of the points" };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].at[axis].total_cmp(&points[b].at[axis]));
    let value = |k: usize| points[order[k]].at[axis];
    let mut steps: Vec<f64> = (1..order.len()).map(|k| value(k) - value(k - 1)).filter(|step| *step > 0.0).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    // the smaller one is rounding, or the spacing, and the larger one a gap
    let small = |pair: &&[f64]| pair[1] < SAME_POSITION * pair[0];
    let large = steps.windows(2).filter(small).map(|pair| pair[0]).chain(steps.last().copied());
    let mut on_grids = large.map(|step| on_axis(points, &order, (name, axis), step));
    // any points lie on a fine enough grid, on which they are sparse
    let is_dense = |found: &RegularAxis| found.cells <= 2 * found.indices.iter().collect::<BTreeSet<_>>().len();
    match on_grids.next() {
        // no points, or all at the same coordinate
        None => Err(least_length(field, order.len().min(1), 2).err().unwrap_or(sparse(points.len(), [1, 1]))),
        Some(first) => first.or_else(|error| on_grids.flatten().find(is_dense).ok_or(error)),
    }
}

/// The regular positions of points in the `order` along an axis, of which `step` approximates the spacing; a straight
/// line through all points makes it accurate.
fn on_axis(points: &[Point], order: &[usize], (name, axis): (&'static str, usize), step: f64) -> Result<RegularAxis> {
    let step = positive("step between the points", step)?;
    let value = |k: usize| points[order[k]].at[axis];
    let mut positions = Vec::with_capacity(order.len());
    let mut position = 0.0;
    for k in 0..order.len() {
        if k > 0 && value(k) - value(k - 1) >= SAME_POSITION * step {
            position += ((value(k) - value(k - 1)) / step).round();
        }
        positions.push(position);
    }
    let (origin, spacing) = fitted_line(&positions, value);
    positive("spacing of the points", spacing)?;
    let off = |k: usize| ((value(k) - origin) / spacing - positions[k]).abs();
    if let Some(k) =
        (0..order.len()).max_by(|&a, &b| off(a).total_cmp(&off(b))).filter(|&k| off(k) > MAX_OFFSET || off(k).is_nan())
    {
        let (line, value, off) = (points[order[k]].line, value(k), off(k));
        let what = format!(
            "line {line}: {name} = {} m is {off:.3} spacings of {} m off the regular grid of the points; \
             {MAX_OFFSET:.3} are allowed",
            rounded(value, 5),
            rounded(spacing, 4)
        );
        let remedy = ": interpolate the points on a regular grid";
        return Err(Refusal::file("map_off_grid", what, remedy).naming(name).valued(value).into());
    }
    let mut indices = vec![0; order.len()];
    for (k, &position) in positions.iter().enumerate() {
        indices[order[k]] = position as usize;
    }
    Ok(RegularAxis { cells: (position as usize).saturating_add(1), spacing, indices })
}

/// Origin and slope of the least-squares straight line through the values at the positions.
fn fitted_line(positions: &[f64], value: impl Fn(usize) -> f64) -> (f64, f64) {
    let count = positions.len() as f64;
    // relative to the first value, so that a distant origin costs no digits
    let first = value(0);
    let mean = positions.iter().sum::<f64>() / count;
    let mean_value = (0..positions.len()).map(|k| value(k) - first).sum::<f64>() / count;
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (k, position) in positions.iter().enumerate() {
        covariance += (position - mean) * (value(k) - first - mean_value);
        variance += (position - mean).powi(2);
    }
    let slope = covariance / variance;
    (first + mean_value - slope * mean, slope)
}
