//! How long the steps of a run are.

/// How long the steps are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stepping {
    /// Equal steps, counted from the time at which following starts; cut where the load has a corner.
    Fixed {
        /// Length of a step \[s\].
        dt: f64,
    },
    /// Steps as long as the error in time allows; short after jumps and corners of the load, long when little happens.
    Adaptive {
        /// Error in time of approach or force.
        tolerance: f64,
    },
}

impl Stepping {
    /// Equal steps of `dt` \[s\], which must be finite and positive.
    pub fn fixed(dt: f64) -> Stepping {
        Stepping::Fixed { dt }
    }

    /// Steps whose error in time is estimated to be at most `tolerance`, in \[1e-9, 0.1\]: the error of the approach where a force
    /// is given, of the force where the approach is. It is relative to displacement or force, where these are large, and
    /// else to the greatest of the run, of which small loads, and loads that begin from nothing, are a part. Errors of the
    /// pressure at a point may be larger, see [`ErrorBudget::pressure`](crate::contact::ErrorBudget::pressure). The solver is
    /// not solved more exactly than suits: [`Settings::tolerance`](crate::contact::Settings::tolerance) or 0.03 of `tolerance`,
    /// whichever is greater.
    pub fn adaptive(tolerance: f64) -> Stepping {
        Stepping::Adaptive { tolerance }
    }
}
