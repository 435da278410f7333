//! What a study measures the error of.

use std::fmt;

use crate::fields::Fields;

/// A quantity of a run whose error a [`Study`](crate::study::Study) measures, at all times relative to its largest
/// value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Observable {
    /// The approach.
    Approach,
    /// The force.
    Force,
    /// The contact area.
    ContactArea,
    /// The maximum pressure of the run. It does not converge under edges and tips, where it is infinite.
    MaxPressure,
}

/// How an observable is read.
pub(super) enum Reading<'a> {
    /// At the end of each step.
    Value(Box<dyn Fn(Fields<'_>) -> f64 + 'a>),
    /// The largest of all steps.
    Greatest(Box<dyn Fn(Fields<'_>) -> f64 + 'a>),
    /// The pressure at the times that were asked for.
    Pressure,
}

/// An observable of a study.
pub(super) struct Observed<'a> {
    pub(super) name: String,
    /// Whether the study ends by its error.
    pub(super) is_asked: bool,
    pub(super) reading: Reading<'a>,
}

impl fmt::Debug for Observed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observed").field("name", &self.name).field("is_asked", &self.is_asked).finish_non_exhaustive()
    }
}

impl Observable {
    pub(super) const ALL: [Observable; 4] =
        [Observable::Approach, Observable::Force, Observable::ContactArea, Observable::MaxPressure];

    pub(super) fn name(self) -> &'static str {
        match self {
            Observable::Approach => "approach",
            Observable::Force => "force",
            Observable::ContactArea => "contact area",
            Observable::MaxPressure => "maximum pressure",
        }
    }

    pub(super) fn observed<'a>(self, is_asked: bool) -> Observed<'a> {
        let reading = match self {
            Observable::Approach => Reading::Value(Box::new(|fields| fields.approach())),
            Observable::Force => Reading::Value(Box::new(|fields| fields.force())),
            Observable::ContactArea => Reading::Value(Box::new(|fields| fields.contact_area())),
            Observable::MaxPressure => Reading::Greatest(Box::new(|fields| fields.max_pressure())),
        };
        Observed { name: self.name().to_owned(), is_asked, reading }
    }
}
