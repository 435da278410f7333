//! What all errors tell: their kind, name, value, range and remedy.

use std::io;

use super::{Error, RanksError, StepError};

/// What sort of failure an [`Error`] is, for programs that map errors to others. The error itself tells field, value
/// and remedy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A value, table, load or function that was given is not allowed here.
    Value,
    /// A file cannot be read, understood or written.
    File,
    /// More memory is needed than is available or allowed.
    Memory,
    /// The caller, or another rank, ended the call.
    Cancelled,
    /// A search did not converge, or needs shorter steps than there are.
    Convergence,
    /// The combination is not covered: another way of computing is needed.
    Unsupported,
}

impl Error {
    /// What sort of failure this is.
    ///
    /// ```
    /// use viscocontact::{ErrorKind, prelude::*};
    ///
    /// assert_eq!(Sphere::new(-1.0).unwrap_err().kind(), ErrorKind::Value);
    /// assert_eq!(HeightMap::from_sdf(&b"no map"[..]).unwrap_err().kind(), ErrorKind::File);
    /// ```
    pub fn kind(&self) -> ErrorKind {
        self.identity().0
    }

    /// A name of this error that does not change: that of its variant, or of what was refused.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let error = Sphere::new(-1.0).unwrap_err();
    /// assert_eq!((error.code(), error.name(), error.value()), ("out_of_range", Some("sphere radius"), Some(-1.0)));
    /// assert_eq!(error.allowed(), Some("finite, > 0 and at most 1e300 m"));
    ///
    /// let map = HeightMap::new([2, 2], [1.0e-3, 1.0e-3], vec![0.0, 1.0e-6, f64::NAN, 0.0])?;
    /// let error = map.power_spectrum().unwrap_err();
    /// assert_eq!(error.code(), "map_incomplete");
    /// assert_eq!(error.remedy().as_deref(), Some("fill them with HeightMap::filled, or crop the map"));
    /// # Ok::<(), Error>(())
    /// ```
    pub fn code(&self) -> &'static str {
        self.identity().1
    }

    /// What is wrong: the argument, setting, column or entry that has the value.
    pub fn name(&self) -> Option<&str> {
        match self {
            Error::OutOfRange { field, .. }
            | Error::CountOutOfRange { field, .. }
            | Error::WrongLength { field, .. }
            | Error::OutOfOrder { field, .. }
            | Error::LoadOutOfRange { field, .. } => Some(field),
            Error::NotCovered { what, .. } | Error::OutOfMemory { what, .. } => Some(what),
            _ => self.refusal()?.0.name,
        }
    }

    /// The value that was given or found.
    pub fn value(&self) -> Option<f64> {
        match *self {
            Error::OutOfRange { value, .. }
            | Error::OutOfOrder { value, .. }
            | Error::LoadOutOfRange { value, .. }
            | Error::InvalidGap { value, .. } => Some(value),
            Error::CountOutOfRange { value, .. } => Some(value as f64),
            Error::WrongLength { len, .. } => Some(len as f64),
            _ => self.refusal()?.0.value,
        }
    }

    /// The values allowed in its place, in words.
    pub fn allowed(&self) -> Option<&str> {
        match self {
            Error::OutOfRange { allowed, .. }
            | Error::CountOutOfRange { allowed, .. }
            | Error::LoadOutOfRange { allowed, .. } => Some(allowed),
            _ => self.refusal()?.0.allowed,
        }
    }

    /// What to do, if the message says so: its end.
    pub fn remedy(&self) -> Option<String> {
        let before = match self {
            Error::NotCovered { remedy, .. } => return Some((*remedy).to_owned()),
            Error::InvalidGap { .. }
            | Error::NothingToTouch { .. }
            | Error::PulledOff { .. }
            | Error::Slides { .. }
            | Error::Shrinks { .. }
            | Error::Step(
                StepError::LoadOutsideHull { .. } | StepError::NoElasticResponse { .. } | StepError::Overflow { .. },
            ) => "; ",
            Error::OutOfMemory { .. }
            | Error::ZoneNotResolved { .. }
            | Error::Step(_)
            | Error::Ranks(RanksError::Left { .. } | RanksError::Apart) => ": ",
            _ => return self.refusal()?.remedy().map(str::to_owned),
        };
        self.to_string().rsplit_once(before).map(|(_, remedy)| remedy.to_owned())
    }

    /// The kind of the system's error behind this one: of a file that could not be read or written. `None` of all
    /// others.
    ///
    /// ```
    /// use std::io::ErrorKind;
    /// use viscocontact::geometry::HeightMap;
    ///
    /// let error = HeightMap::read("no/such/map.sdf").unwrap_err();
    /// assert_eq!(error.io_kind(), Some(ErrorKind::NotFound));
    /// ```
    pub fn io_kind(&self) -> Option<io::ErrorKind> {
        match self {
            Error::Output(error) => Some(error.kind()),
            Error::Unreadable { kind, .. } => *kind,
            _ => self.refusal()?.0.io_kind,
        }
    }

    fn identity(&self) -> (ErrorKind, &'static str) {
        use ErrorKind::{Cancelled, Convergence, File, Memory, Unsupported, Value};
        match self {
            Error::NotCovered { .. } => (Unsupported, "not_covered"),
            Error::OutOfRange { .. } => (Value, "out_of_range"),
            Error::CountOutOfRange { .. } => (Value, "count_out_of_range"),
            Error::OutOfMemory { .. } => (Memory, "out_of_memory"),
            Error::WrongLength { .. } => (Value, "wrong_length"),
            Error::OutOfOrder { .. } => (Value, "out_of_order"),
            Error::LoadOutOfRange { .. } => (Value, "load_out_of_range"),
            Error::InvalidGap { .. } => (Value, "invalid_gap"),
            Error::NothingToTouch { .. } => (Value, "nothing_to_touch"),
            Error::ZoneNotResolved { .. } => (Value, "zone_not_resolved"),
            Error::PulledOff { .. } => (Value, "pulled_off"),
            Error::Slides { .. } => (Value, "slides"),
            Error::Shrinks { .. } => (Unsupported, "shrinks"),
            Error::Unreadable { .. } => (File, "unreadable"),
            Error::Output(_) => (File, "output"),
            Error::User(_) => (Value, "user"),
            Error::Cancelled { .. } => (Cancelled, "cancelled"),
            Error::Ranks(RanksError::Left { .. }) => (Cancelled, "rank_left"),
            Error::Ranks(RanksError::Failed { .. }) => (Cancelled, "rank_failed"),
            Error::Ranks(RanksError::Apart) => (Cancelled, "ranks_apart"),
            Error::Step(StepError::TiltOfPeriodic { .. }) => (Unsupported, "tilt_of_periodic"),
            Error::Step(StepError::LoadOutsideHull { .. }) => (Value, "load_outside_hull"),
            Error::Step(StepError::ContactAtEdge { .. }) => (Value, "contact_at_edge"),
            Error::Step(StepError::BeyondFullContact { .. }) => (Value, "beyond_full_contact"),
            Error::Step(StepError::ThroughLayer { .. }) => (Value, "through_layer"),
            Error::Step(StepError::BeyondMaterial { .. }) => (Value, "beyond_material"),
            Error::Step(StepError::NoElasticResponse { .. }) => (Value, "no_elastic_response"),
            Error::Step(StepError::NotConverged { .. }) => (Convergence, "not_converged"),
            Error::Step(StepError::StepTooShort { .. }) => (Convergence, "step_too_short"),
            Error::Step(StepError::Overflow { .. }) => (Value, "overflow"),
            Error::Refused(refusal) | Error::Checkpoint { cause: refusal, .. } => (refusal.0.kind, refusal.0.code),
        }
    }

    /// Whether it has this code and name.
    #[cfg(test)]
    pub(crate) fn is(&self, code: &str, name: &str) -> bool {
        self.code() == code && self.name() == Some(name)
    }
}
