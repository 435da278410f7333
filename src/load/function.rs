use crate::ascending::Ascending;
use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// A load history given by a closure of time \[s\].
///
/// ```
/// use viscocontact::load::{FnHistory, Load, LoadHistory};
///
/// let history = FnHistory::new(|t: f64| Load::force((1.0 - t).abs())).with_breakpoints(&[1.0])?;
/// assert_eq!(history.at(3.0), Load::force(2.0));
/// assert_eq!(history.next_breakpoint(0.0), Some(1.0));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct FnHistory<F> {
    load: F,
    breakpoints: Ascending,
}

impl<F: Fn(f64) -> Load + Send + Sync> FnHistory<F> {
    /// Wraps the closure, taken to be smooth; each step checks its load.
    pub fn new(load: F) -> FnHistory<F> {
        FnHistory { load, breakpoints: Ascending::default() }
    }

    /// The same history with corners at `times` \[s\], in any order: steps end exactly there. A closure has one value
    /// per time and cannot jump: a jump becomes a ramp over the step before. For jumps implement
    /// [`LoadHistory::before`], or use [`PiecewiseLinear`](crate::load::PiecewiseLinear).
    ///
    /// # Errors
    /// If a time is not finite.
    pub fn with_breakpoints(mut self, times: &[f64]) -> Result<FnHistory<F>> {
        self.breakpoints.add("breakpoint", times)?;
        Ok(self)
    }
}

debug_by!(self: FnHistory<F> => breakpoints: self.breakpoints.as_slice());

impl<F: Fn(f64) -> Load + Send + Sync> LoadHistory for FnHistory<F> {
    fn at(&self, t: f64) -> Load {
        (self.load)(t)
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.breakpoints.after(after)
    }
}
