//! What pulls surfaces together that are near each other.

use std::fmt::Debug;

use crate::error::UserError;

/// A law of attraction: a traction that never grows with the gap. Implementations are tested by
/// [`laws::all`](crate::adhesion::laws::all).
///
/// ```
/// use viscocontact::adhesion::{Attraction, laws};
///
/// /// s = (w/ρ)/(1 + h/ρ)².
/// #[derive(Debug)]
/// struct InverseSquare { work: f64, range: f64 }
///
/// impl Attraction for InverseSquare {
///     fn traction(&self, gap: f64) -> f64 {
///         self.work / self.range / (1.0 + gap / self.range).powi(2)
///     }
///     fn energy(&self, gap: f64) -> f64 {
///         self.work / (1.0 + gap / self.range)
///     }
/// }
/// let law = InverseSquare { work: 0.05, range: 20.0e-9 };
/// assert!((law.range() - 20.0e-9).abs() < 1e-20);
/// laws::all(&law).map_err(|violation| violation.to_string())?;
/// # Ok::<(), String>(())
/// ```
pub trait Attraction: Debug + Send + Sync {
    /// The traction s(h) that pulls a cell of `gap` h ≥ 0 \[m\] towards the other body, ≥ 0 and never growing with h
    /// \[Pa\].
    fn traction(&self, gap: f64) -> f64;

    /// The work ∫ₕ^∞ s dh that opens the `gap` from h to infinity \[J/m²\].
    fn energy(&self, gap: f64) -> f64;

    /// The work of separation w = ∫₀^∞ s dh \[J/m²\].
    fn work(&self) -> f64 {
        self.energy(0.0)
    }

    /// The range ρ = w/s(0) \[m\]: over this gap the maximum traction would do the work of separation.
    fn range(&self) -> f64 {
        self.energy(0.0) / self.traction(0.0)
    }

    /// Why the last value was none, of a law that can fail: such a value is NaN, and this error comes out of the call
    /// that needed it.
    fn failure(&self) -> Option<UserError> {
        None
    }
}

/// Implements [`Attraction`] for a pointer by the law that it points to.
macro_rules! forward_attraction {
    ($($pointer:ty),*) => {
        $(forward! {
            Attraction, (<T> self: $pointer => **self),
            traction(gap: f64) -> f64;
            energy(gap: f64) -> f64;
            work() -> f64;
            range() -> f64;
            failure() -> Option<UserError>;
        })*
    };
}
forward_attraction!(&T, Box<T>, std::sync::Arc<T>);
