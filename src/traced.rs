//! Events for `tracing`, with the feature `tracing`; without it they do nothing.

use crate::Error;

/// Functions that emit an event each: name and arguments, level, and what the event contains.
macro_rules! events {
    ($($(#[$doc:meta])* $name:ident($($argument:ident: $type:ty),*) = $level:ident!($($fields:tt)*);)*) => {$(
        $(#[$doc])*
        #[inline]
        pub(crate) fn $name($($argument: $type),*) {
            #[cfg(feature = "tracing")]
            tracing::$level!($($fields)*);
            #[cfg(not(feature = "tracing"))]
            let _ = ($($argument,)*);
        }
    )*};
}

events! {
    /// A step was too long, and is repeated with a shorter one.
    rejected(time: f64, dt: f64, error: f64, tolerance: f64) = warn!(time, dt, error, tolerance, "step rejected");
    /// A step failed.
    failed(time: f64, dt: f64, error: &Error) = warn!(time, dt, %error, "step failed");
    /// The computed part of the grid changed.
    moved(from: [usize; 2], to: [usize; 2]) = debug!(?from, ?to, "region moved");
    /// A series was fitted to a material.
    fitted(times: [f64; 2], terms: usize, misfit: f64) =
        debug!(first = times[0], last = times[1], terms, misfit, "series fitted");
}
