//! Numerical methods that this crate and `viscocontact-identify` share.

mod hermite;
#[cfg(feature = "data")]
mod least_squares;
mod minimum;
mod non_negative;
mod root;

pub use hermite::{hermite, hermite_slope};
#[cfg(feature = "data")]
pub use least_squares::{LeastSquares, least_squares};
pub(crate) use minimum::golden_section;
pub use minimum::minimum;
pub use non_negative::non_negative_least_squares;
pub use root::root;

/// Euler's constant γ.
pub(crate) const EULER: f64 = 0.577_215_664_901_532_9;
