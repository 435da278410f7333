//! Events for `tracing`, with the feature `tracing`; without it they do nothing.

#[cfg(feature = "tracing")]
use tracing::{debug, warn};

use crate::Error;

/// A step was too long, and is repeated with a shorter one.
#[inline]
pub(crate) fn rejected(time: f64, dt: f64, error: f64, tolerance: f64) {
    #[cfg(feature = "tracing")]
    warn!(time, dt, error, tolerance, "step rejected");
    #[cfg(not(feature = "tracing"))]
    let _ = (time, dt, error, tolerance);
}

/// A step failed.
#[inline]
pub(crate) fn failed(time: f64, dt: f64, error: &Error) {
    #[cfg(feature = "tracing")]
    warn!(time, dt, %error, "step failed");
    #[cfg(not(feature = "tracing"))]
    let _ = (time, dt, error);
}

/// The computed part of the grid changed.
#[inline]
pub(crate) fn moved(from: [usize; 2], to: [usize; 2]) {
    #[cfg(feature = "tracing")]
    debug!(from = ?from, to = ?to, "region moved");
    #[cfg(not(feature = "tracing"))]
    let _ = (from, to);
}

/// A series was fitted to a material.
#[inline]
pub(crate) fn fitted(times: [f64; 2], terms: usize, misfit: f64) {
    #[cfg(feature = "tracing")]
    debug!(first = times[0], last = times[1], terms, misfit, "series fitted");
    #[cfg(not(feature = "tracing"))]
    let _ = (times, terms, misfit);
}
