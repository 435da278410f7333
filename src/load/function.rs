use crate::ascending::Ascending;
use crate::error::{Failure, Result, UserError};
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
    failure: Failure,
}

impl FnHistory<fn(f64) -> Load> {
    /// Wraps a closure that may fail: its error comes out of the step that needed the load, as the source of
    /// [`Error::User`](crate::Error::User).
    pub fn fallible<E: Into<Box<dyn std::error::Error + Send + Sync>>>(
        load: impl Fn(f64) -> Result<Load, E> + Send + Sync,
    ) -> FnHistory<impl Fn(f64) -> Load + Send + Sync> {
        let failure = Failure::default();
        let caught = failure.clone();
        let load = move |t| caught.or("the load history", load(t), Load::force(f64::NAN));
        FnHistory { load, breakpoints: Ascending::default(), failure }
    }
}

impl<F: Fn(f64) -> Load + Send + Sync> FnHistory<F> {
    /// Wraps the closure, taken to be smooth; each step checks its load.
    pub fn new(load: F) -> FnHistory<F> {
        FnHistory { load, breakpoints: Ascending::default(), failure: Failure::default() }
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

    fn failure(&self) -> Option<UserError> {
        self.failure.take()
    }
}
