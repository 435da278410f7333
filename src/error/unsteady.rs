use crate::rounded::{TIME, rounded};

/// Why a motion has not become steady.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unsteady {
    /// The pressure still changes: the track was too short, or contact comes and goes, as on a rough track.
    #[error(
        "the pressure still changes by {change:.1e} over a contact length: travel farther \
        (SteadyMotion::with_max_distance); contact that comes and goes has no steady state"
    )]
    Changing {
        /// Change of the pressure over a contact length, Σ |Δp| over Σ p.
        change: f64,
    },

    /// A slow term of creep is far from its limit.
    #[error(
        "creep of the retardation time {time} s has still to change approach or lateral force by {remaining:.1e} \
        of its value: travel about {} m farther \
        (SteadyMotion::with_max_distance)", rounded(*.farther, 2), time = rounded(*.time, TIME)
    )]
    SlowTerm {
        /// The retardation time \[s\].
        time: f64,
        /// Change of approach or lateral force still to come, relative to its value.
        remaining: f64,
        /// Estimated distance still to travel \[m\].
        farther: f64,
    },

    /// What has left the grid behind the contact still acts on it: the bodies recover over a longer distance.
    #[error(
        "the grid ends {} m behind the contact; what lies beyond would change approach or lateral force by up to \
        {missing:.1e} of its value: let the grid reach {} m behind the \
        contact", rounded(*.behind, 3), rounded(*.needed, 2)
    )]
    LeftGrid {
        /// Bound of the change of approach or lateral force, relative to its value.
        missing: f64,
        /// Distance from the contact to the end of the grid behind it \[m\].
        behind: f64,
        /// Distance that is enough \[m\].
        needed: f64,
    },
}
