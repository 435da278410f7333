//! What some contacts do not cover: the table of parts and calls, and what to do in place of each.

use Special::{Attraction, FixedToBodies, FixedToIndenter, Friction, OwnContact, Ranks, SteadyMotion};

use super::{Error, Result};

/// What makes a scene special, so that it does not cover all that others do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Special {
    /// Surfaces attract each other ([`crate::adhesion`]).
    Attraction,
    /// The contact moves steadily ([`crate::sliding`]).
    SteadyMotion,
    /// Ranks share out the rows of the grid ([`crate::parallel`]).
    Ranks,
    /// The grid is fixed to the bodies ([`Frame::Bodies`](crate::contact::Frame::Bodies)).
    FixedToBodies,
    /// The grid is fixed to the indenter ([`Frame::Indenter`](crate::contact::Frame::Indenter)).
    FixedToIndenter,
    /// Bodies rub (`friction`).
    Friction,
    /// The contact is of a user's own type ([`Contact`](crate::run::Contact)).
    OwnContact,
}

impl Special {
    /// What [`Error::NotCovered`] says of it.
    fn said(self) -> &'static str {
        match self {
            Attraction => "where surfaces attract each other",
            SteadyMotion => "in steady motion",
            Ranks => "on rows that ranks share out",
            FixedToBodies => "on a grid that is fixed to the bodies",
            FixedToIndenter => "on a grid that is fixed to the indenter",
            Friction => "where bodies rub",
            OwnContact => "of a contact of your own",
        }
    }
}

/// A part of a scene or a call, and the special scenes that do not cover it, each with its remedy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case(&'static str, &'static [(Special, &'static str)]);

const ONE_PROCESS: &str = "compute the contact in one process";
const OTHER_FRAME: &str = "choose the other Frame with Settings::with_frame";
const STRESS_OF_TRACTION: &str = "make a SubsurfaceStress from ViscoelasticContact::traction_into";

/// A table of cases.
macro_rules! not_covered {
    ($($(#[$attribute:meta])* $name:ident: $what:literal, $($special:ident: $remedy:expr),+;)*) => {
        $($(#[$attribute])* pub(crate) const $name: $crate::error::coverage::Case = $crate::error::coverage::Case::new($what, &[$(($special, $remedy)),+]);)*
    };
}

pub(crate) use not_covered;

not_covered! {
    // parts of a scene
    SEVERAL_BODIES: "a contact of several rigid bodies",
        Ranks: ONE_PROCESS, Attraction: "compute one body", SteadyMotion: "take one", Friction: "take one";
    FRAME_OF_INDENTER: "Frame::Indenter",
        Ranks: ONE_PROCESS, Attraction: "take Frame::Bodies", Friction: "take Frame::Bodies";
    SHARED_ROWS: "a contact that ranks share out",
        Attraction: "compute it in one process", SteadyMotion: "compute it in one process",
        Friction: ONE_PROCESS;
    FOUND_DOMAIN: "a study that finds its domain", Attraction: "give its sides (Study::domain), wide enough for the attraction to end";
    ATTRACTED: "a contact of surfaces that attract each other",
        SteadyMotion: "build it without attraction", Friction: "build it without attraction";
    TEMPERATURES: "a history of the temperature",
        SteadyMotion: "multiply the velocity by the shift factor of the temperature";
    OTHER_ROWS: "a geometry that was given for other ranks", Ranks: ONE_PROCESS;

    // steps and their loads
    STEP_ALONG_PATH: "a step along a path",
        Ranks: ONE_PROCESS, Attraction: "keep the indenter in place", FixedToIndenter: OTHER_FRAME;
    STEP_OVER_BODIES: "a step over the bodies", FixedToBodies: OTHER_FRAME;
    OTHER_GEOMETRY: "another geometry", Ranks: ONE_PROCESS;
    BROKEN_SYMMETRY: "a load that breaks the symmetry of the scene (unless Settings::symmetry is false)",
        Ranks: ONE_PROCESS;

    #[cfg(feature = "checkpoint")]
    RUN_IN_FILE: "a run in a file", OwnContact: "keep its state by code of your own, after each step (Run::contact)";

    // observations
    STRESS: "the stress below the surface", Ranks: ONE_PROCESS, Attraction: STRESS_OF_TRACTION;
    ENERGIES: "an energy balance", Ranks: ONE_PROCESS, FixedToIndenter: OTHER_FRAME;
    MESH_ERROR: "the error due to the mesh", Ranks: ONE_PROCESS, Attraction: "compute on a finer mesh, and compare";
    PATCHES: "the search for patches", Ranks: ONE_PROCESS;
    #[cfg(feature = "plot")]
    PICTURE: "a picture of fields", Ranks: ONE_PROCESS;
}

impl Case {
    pub(crate) const fn new(what: &'static str, special: &'static [(Special, &'static str)]) -> Case {
        Case(what, special)
    }

    fn refused(self, (special, remedy): (Special, &'static str)) -> Error {
        Error::NotCovered { special: special.said(), what: self.0, remedy }
    }

    /// The error in the first of its special scenes.
    pub(crate) fn error(self) -> Error {
        self.refused(self.1[0])
    }

    /// Fails in the first of its special scenes that `is` the case.
    pub(crate) fn refuse_if(self, mut is: impl FnMut(Special) -> bool) -> Result<()> {
        let found = self.1.iter().find(|(special, _)| is(*special));
        found.map_or(Ok(()), |special| Err(self.refused(*special)))
    }
}
