//! Numerical methods that this crate and `viscocontact-identify` share.

mod hermite;
mod least;
#[cfg(feature = "data")]
mod least_squares;
mod non_negative;
mod root;

pub use hermite::{hermite, hermite_slope};
pub use least::{golden_section, least};
#[cfg(feature = "data")]
pub use least_squares::{LeastSquares, least_squares};
pub use non_negative::non_negative_least_squares;
pub use root::root;

/// Euler's constant γ.
pub(crate) const EULER: f64 = 0.577_215_664_901_532_9;
