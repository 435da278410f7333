//! Errors of functions that users write.

use std::error::Error as StdError;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// A load history, a gap or a creep function could not give a value; its own error is the
/// [`source`](std::error::Error::source).
///
/// ```
/// use std::error::Error as _;
/// use viscocontact::prelude::*;
///
/// let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))?;
/// let load = FnHistory::fallible(|t: f64| "0.5 N".trim_end_matches(" N").parse().map(|force: f64| Load::force(force * t)));
/// contact.follow(&load, Stepping::fixed(0.1), 1.0).next_step()?;
/// let load = FnHistory::fallible(|_| "half a newton".parse().map(Load::force));
/// let error = contact.follow(&load, Stepping::fixed(0.1), 2.0).next_step().unwrap_err();
/// assert!(matches!(&error, Error::User(_)));
/// assert!(error.source().unwrap().is::<std::num::ParseFloatError>());
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct UserError {
    what: &'static str,
    source: Arc<dyn StdError + Send + Sync>,
}

impl UserError {
    /// An error of `what`, such as "the load history".
    pub fn new(what: &'static str, source: impl Into<Box<dyn StdError + Send + Sync>>) -> UserError {
        UserError { what, source: Arc::from(source.into()) }
    }
}

impl fmt::Display for UserError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} failed", self.what)
    }
}

impl StdError for UserError {
    fn source(&self) -> Option<&(dyn StdError + 'static)> {
        Some(&*self.source)
    }
}

/// Errors are equal if they are the same failure.
impl PartialEq for UserError {
    fn eq(&self, other: &UserError) -> bool {
        Arc::ptr_eq(&self.source, &other.source)
    }
}

/// What `compute` makes of values of a user's function, or the error of the function in this call: `failure` takes
/// it, and one of an earlier call before.
pub(crate) fn or_failure_of<T>(
    failure: impl Fn() -> Option<UserError>,
    compute: impl FnOnce() -> crate::Result<T>,
) -> crate::Result<T> {
    drop(failure());
    let computed = compute();
    failure().map_or(computed, |failure| Err(failure.into()))
}

/// The last error of a closure, which returns a value that no check accepts in its place.
#[derive(Clone, Default)]
pub(crate) struct Failure(Arc<Mutex<Option<UserError>>>);

impl Failure {
    pub(crate) fn or<T, E>(&self, what: &'static str, result: Result<T, E>, instead: T) -> T
    where
        E: Into<Box<dyn StdError + Send + Sync>>,
    {
        result.unwrap_or_else(|error| {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(UserError::new(what, error));
            instead
        })
    }

    pub(crate) fn take(&self) -> Option<UserError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
