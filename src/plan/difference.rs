//! Differences between two runs.

use crate::plan::scene::{Run, StepState, TrialScene};

/// Differences between two runs of the same times, or of two lists of elastic states, relative to the greatest values of the finer run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Differences {
    /// Of approach or force at any time.
    pub(super) main: f64,
    /// Of the greatest pressure of the run, or of one state.
    pub(super) pressure: f64,
    /// Of the greatest pressure at any time at which the coarse run resolves the contact.
    pub(super) pressure_over_time: f64,
    /// Of the contact radius at these times.
    pub(super) radius: f64,
}

impl Differences {
    /// The pressure is compared in the state with the index `highest`, or between the greatest ones of all states.
    pub(super) fn between(coarse: &[StepState], fine: &[StepState], highest: Option<usize>) -> Differences {
        let over = |of: fn(&StepState) -> f64, all: bool| {
            let pairs = coarse.iter().zip(fine).filter(|(state, _)| all || state.resolved);
            let most = pairs.map(|(coarse, fine)| (of(coarse) - of(fine)).abs()).fold(0.0, f64::max);
            relative(most, greatest(fine, of))
        };
        let [before, now] = [coarse, fine].map(|states| {
            let of_one = highest.and_then(|highest| states.get(highest)).map(|state| state.pressure);
            of_one.unwrap_or_else(|| greatest(states, |state| state.pressure))
        });
        Differences {
            main: over(|state| state.approach, true).max(over(|state| state.force, true)),
            pressure: relative((before - now).abs(), now),
            pressure_over_time: over(|state| state.pressure, false),
            radius: over(|state| state.radius, false),
        }
    }
}

/// The share of the greatest of values, given with their times, that a run in steps of these lengths misses where its steps end least
/// luckily: two of them around the greatest value.
pub(super) fn unseen(scene: &TrialScene<'_>, run: &Run, values: &[[f64; 2]]) -> f64 {
    let Some(&[at, greatest]) = values.iter().max_by(|a, b| a[1].total_cmp(&b[1])) else { return 0.0 };
    // every run ends a step at a corner, and at its end
    let (mut start, mut end) = (0.0, scene.next_corner(0.0));
    while end <= at {
        (start, end) = (end, scene.next_corner(end));
    }
    if at <= start || at >= scene.asked.until {
        return 0.0;
    }
    let end = end.min(scene.asked.until);
    let step = run.states.partition_point(|state| state.time < at);
    let around = run.steps.iter().skip(step.saturating_sub(1)).take(3);
    let length = around.map(|(dt, _)| *dt).fold(0.0, f64::max);
    missed(values, at, greatest, [start, end], length)
}

/// The share of the greatest value that steps of this length miss, wherever they end between two corners.
fn missed(values: &[[f64; 2]], at: f64, greatest: f64, [start, end]: [f64; 2], length: f64) -> f64 {
    let within = values.iter().filter(|[time, _]| *time > start && (at - length..=at).contains(time));
    let shown = within.map(|&[time, before]| {
        let next = values.iter().find(|[next, _]| *next >= end.min(time + length));
        next.map_or(before, |[_, after]| before.max(*after))
    });
    relative(greatest - shown.fold(greatest, f64::min), greatest)
}

pub(super) fn relative(value: f64, scale: f64) -> f64 {
    if scale > 0.0 { value / scale } else { 0.0 }
}

pub(super) fn greatest(states: &[StepState], of: impl Fn(&StepState) -> f64) -> f64 {
    states.iter().map(|state| of(state).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::missed;

    /// A parabola 1 − (t/2)² is missed most by a step that lies evenly about its vertex; a corner beside the vertex ends a step.
    #[test]
    fn what_steps_miss_of_a_peak() {
        let values: Vec<[f64; 2]> =
            (-1000..=1000).map(|k| f64::from(k) * 1e-3).map(|t| [t, 1.0 - 0.25 * t * t]).collect();
        for length in [0.1_f64, 0.4, 0.8] {
            let found = missed(&values, 0.0, 1.0, [-1.0, 1.0], length);
            assert!((found - 0.0625 * length * length).abs() < 2e-3 * length, "{length}: {found}");
            let beside = missed(&values, 0.0, 1.0, [-1.0, 0.1 * length], length);
            assert!((beside - 0.0025 * length * length).abs() < 2e-3 * length, "{length}: {beside}");
        }
    }
}
