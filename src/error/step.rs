use crate::axis::Axis;
use crate::rounded::{TIME, rounded};

/// A solver that makes no progress at residuals above this is not hindered by rounding.
const STALLED: f64 = 1e-3;

/// Why a step of a contact failed, or a run of steps. The contact is as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A load tilts a body along an axis along which the bodies are periodic.
    #[error("at t = {time} s the load tilts the body along {axis}, along which the bodies are periodic: prescribe \
        no tilt there, or take a body that is not periodic", time = rounded(*.time, TIME))]
    TiltOfPeriodic {
        /// End of the step \[s\].
        time: f64,
        /// The axis.
        axis: Axis,
    },

    /// A force acts outside the convex hull of the cells that the body may touch, so that no pressure balances it.
    #[error("at t = {time} s the load acts at ({}, {}) m, outside the convex hull of the cells that body {body} \
        may touch: it would tip over; move it inside, or prescribe the \
        tilt", rounded(.at[0], 4), rounded(.at[1], 4), time = rounded(*.time, TIME))]
    LoadOutsideHull {
        /// End of the step \[s\].
        time: f64,
        /// Index of the body.
        body: usize,
        /// The point at which the load acts \[m\]; 0 along an axis whose tilt is prescribed, where it does not matter.
        at: [f64; 2],
    },

    /// Contact reaches the edge of the grid, beyond which the bodies continue: the pressure there would be wrong.
    /// Enlarge the grid, or choose [`Edge::Allow`](crate::contact::Edge::Allow) if the body really ends at the edge of
    /// the grid.
    #[error(
        "at t = {time} s the contact touches the edge of the grid on {cells} cells; {}: enlarge the grid, give a \
        surface that repeats a periodic body (InfluenceKernel::periodic), or set Settings::edge to Edge::Allow if \
        the body ends there", widths(*.lengths, *.needed), time = rounded(*.time, TIME))]
    ContactAtEdge {
        /// End of the step \[s\].
        time: f64,
        /// Number of cells in contact along the edge.
        cells: usize,
        /// Lengths of the grid \[m\].
        lengths: [f64; 2],
        /// Estimated lengths of a grid that holds the contact \[m\]; `None` without an estimate, as of rough bodies.
        needed: Option<[f64; 2]>,
    },

    /// An approach exceeds the approach of full contact on a surface whose mean displacement is fixed
    /// ([`InfluenceKernel::periodic`](crate::InfluenceKernel::periodic)): no pressure closes the gap further.
    #[error(
        "at t = {time} s the approach {} m is not below {} m, that of full contact, which no pressure can exceed \
        on a periodic body: prescribe the \
        force", rounded(*.approach, 5), rounded(*.maximum, 5), time = rounded(*.time, TIME))]
    BeyondFullContact {
        /// End of the step \[s\].
        time: f64,
        /// The approach prescribed \[m\].
        approach: f64,
        /// The approach of full contact \[m\].
        maximum: f64,
    },

    /// The bodies are pressed into a layer on a rigid base by its whole thickness or more: the base would be touched,
    /// and strains are far from small. Press less, or check that lengths are in m, and that the thickness of the
    /// [`Layer`](crate::Layer) comes before Poisson's ratio.
    #[error(
        "at t = {time} s the bodies are pressed {} m deep into a layer {} m thick, through its base: press less \
        (a fifth of the thickness is warned of), or check the thickness, which is in \
        m", rounded(*.depth, 4), rounded(*.thickness, 5), time = rounded(*.time, TIME))]
    ThroughLayer {
        /// End of the step \[s\].
        time: f64,
        /// Maximum displacement in contact \[m\].
        depth: f64,
        /// Thickness of the layer \[m\].
        thickness: f64,
    },

    /// The loading time exceeds the range in which the material is known: the data of a table, or the times that a
    /// series was fitted over. Give [`Builder::times`](crate::contact::Builder::times) a longer range, or extrapolate
    /// the table.
    #[error(
        "at t = {time} s the loading time {age} s exceeds the range in which the material is known, {known_until} \
        s: fit its series over longer times (Builder::times), or extrapolate its table \
        (CreepSeries::extrapolated)", time = rounded(*.time, TIME), age = rounded(*.age, TIME))]
    BeyondMaterial {
        /// End of the step \[s\].
        time: f64,
        /// Loading time: time since the bodies were undisturbed \[s\].
        age: f64,
        /// [`Rheology::known_until`](crate::rheology::Rheology::known_until) \[s\].
        known_until: f64,
    },

    /// The body has no elastic response (J(0) = 0, as Kelvin–Voigt). It cannot follow a jump of the load, a step of
    /// length zero, unless the jump removes the load or the present state already satisfies it. Ramp the load over a short time, or give the body a glassy compliance.
    #[error(
        "at t = {time} s: {what} needs an elastic response, but the material has none (its compliance at t = 0 is \
        zero); ramp the load over a short time or add a glassy compliance", time = rounded(*.time, TIME))]
    NoElasticResponse {
        /// Time of the contact \[s\].
        time: f64,
        /// The call.
        what: &'static str,
    },

    /// The solver did not converge within [`Settings::max_iterations`](crate::contact::Settings::max_iterations), or
    /// made no more progress.
    #[error(
        "at t = {time} s (step of {dt} s): residual {residual:.2e} after {iterations} iterations, above the \
        tolerance {tolerance:e}; {}", progress(*.residual, *.stagnated), time = rounded(*.time, TIME),
        dt = rounded(*.dt, TIME))]
    NotConverged {
        /// End of the step \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Iterations done.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual allowed.
        tolerance: f64,
        /// Whether the solver ended because no iteration made progress, not because its iterations were spent.
        stagnated: bool,
    },

    /// The allowed error in time needs a step below the resolution of `f64` at this time: the load changes too fast, or
    /// the tolerance is too small.
    #[error(
        "at t = {time} s no step that f64 resolves keeps the error in time below {tolerance:e}: name the time of \
        a jump inside a closure with FnHistory::with_breakpoints, ramp the load, allow a greater error, or \
        approach a body that resists rates alone by a spring", time = rounded(*.time, TIME))]
    StepTooShort {
        /// Time of the contact \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Error in time allowed.
        tolerance: f64,
    },

    /// A quantity overflowed in a step: the scales of lengths, moduli, loads and times are too far apart for `f64`.
    #[error("at t = {time} s: {what} is not finite; the scales of the scene are too far apart for f64; check \
        their units", time = rounded(*.time, TIME))]
    Overflow {
        /// End of the step \[s\].
        time: f64,
        /// The quantity that overflowed.
        what: &'static str,
    },
}

/// What a solve that did not converge needs.
fn progress(residual: f64, stagnated: bool) -> &'static str {
    match (stagnated, residual > STALLED) {
        (true, true) => "it stagnates far above rounding: take smaller steps",
        (true, false) => {
            "it stagnates at the level of rounding: raise Settings::tolerance above that, or bring the scales of the \
            scene closer together (a grid not much larger than the contact)"
        }
        (false, _) => "it may fall further: raise Settings::max_iterations",
    }
}

/// How wide the grid is, and how wide it should be.
fn widths(lengths: [f64; 2], needed: Option<[f64; 2]>) -> String {
    let area = |lengths: [f64; 2], digits: usize| {
        let [a, b] = lengths.map(|length| rounded(length, digits));
        format!("{a} m × {b} m")
    };
    let grid = format!("the grid is {}", area(lengths, 3));
    needed.map_or(grid.clone(), |needed| format!("{grid}, the load needs about {}", area(needed, 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps far from a solution are to be shorter, those at rounding are not to be solved more exactly.
    #[test]
    fn what_a_solve_needs_follows_from_its_end() {
        let text = |residual: f64, stagnated: bool| {
            let tolerance = 1e-9;
            StepError::NotConverged { time: 1.0, dt: 0.5, iterations: 40, residual, tolerance, stagnated }.to_string()
        };
        assert!(text(2e-2, true).contains("smaller steps"));
        assert!(text(3e-8, true).contains("raise Settings::tolerance"));
        assert!(text(3e-8, false).contains("raise Settings::max_iterations"));
    }
}
