use super::{ErrorKind, Violation};
use crate::rounded::{TIME, rounded};

/// What goes wrong with surfaces that attract each other.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AdhesionError {
    /// The law is no attraction: it grows with the gap, repels, or its energy is not its integral.
    #[error("the attraction breaks a law: {0}; adhesion::laws::all tests it")]
    Law(Violation),

    /// The mesh does not resolve the zone in which the attraction acts.
    #[error(
        "the attraction acts over a zone of {cells:.2} cells at the edge of the contact, and at least {minimum} are \
        needed: take cells of at most {} m, or a range of at least {} m (a longer range at the same work of \
        separation changes the pull-off force of an elastic body by little while Tabor's number stays above 3; on \
        a creeping body it stands for a slower pull)",
        rounded(*.spacing, 3), rounded(*.range, 3)
    )]
    ZoneNotResolved {
        /// Cells in the zone: E* at once over the steepest slope of the attraction, or over w/ρ² if that is more, and
        /// over the side of a cell.
        cells: f64,
        /// Minimum number of cells.
        minimum: f64,
        /// Maximum side of a cell that resolves the zone \[m\].
        spacing: f64,
        /// Minimum range of the attraction that this mesh resolves \[m\].
        range: f64,
    },

    /// The load pulls harder than the surfaces hold: no state carries it. The contact stays as it was before the
    /// step; under a given approach ([`Load::approach`](crate::load::Load::approach)) it continues apart:
    ///
    /// ```
    /// use viscocontact::adhesion::{AdhesionError, ExponentialAttraction};
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(24, 8.0)?)
    ///     .geometry(&Sphere::new(1.0)?)
    ///     .material(Material::incompressible(Zener::relaxing(0.5, 0.25, 1.0)?))
    ///     .attraction(ExponentialAttraction::new(1.0, 1.0)?)
    ///     .settings(Settings::default().with_edge(Edge::Allow))
    ///     .build()?;
    /// contact.step(1.0, Load::force(1.0))?;
    /// // a pull that grows, until it separates the bodies
    /// let pulled_off = (1..).find_map(|k| contact.step(0.5, Load::force(-0.5 * f64::from(k))).err());
    /// let Some(Error::Adhesion(AdhesionError::PulledOff { time, force })) = pulled_off else { panic!("{pulled_off:?}") };
    /// assert!(force < -4.0 && time == contact.time() + 0.5);
    /// // 20 R away nothing acts: the surface recovers
    /// contact.step(0.5, Load::approach(-20.0))?;
    /// assert!(contact.fields().is_separated());
    /// # Ok::<(), Error>(())
    /// ```
    #[error("at t = {} s the force of {} N pulls the bodies off: no contact carries it; go on under a given \
        approach, or with a spring", rounded(*.time, TIME), rounded(*.force, 5))]
    PulledOff {
        /// End of the step \[s\].
        time: f64,
        /// The force of the load \[N\].
        force: f64,
    },

    /// The attraction beyond the edge of the grid, which is not computed, would add more than 5 % of the force.
    /// Enlarge the grid, or choose
    /// [`Edge::Allow`](crate::contact::Edge::Allow) if the body really ends there. From 1e-3 on steps warn
    /// ([`Warnings::BEYOND_EDGE`](crate::contact::Warnings::BEYOND_EDGE)).
    #[error("at t = {} s the attraction beyond the edge of the grid of {} × {} m would add {:.0} % of the force, \
        where 5 % are allowed: enlarge the grid, give a surface that repeats a periodic body \
        (InfluenceKernel::periodic), or set Settings::edge to Edge::Allow if the body ends \
        there", rounded(*.time, TIME), rounded(.lengths[0], 4), rounded(.lengths[1], 4), 100.0 * share)]
    BeyondEdge {
        /// End of the step \[s\].
        time: f64,
        /// The part of the force that is left out.
        share: f64,
        /// Lengths of the grid \[m\].
        lengths: [f64; 2],
    },

    /// The passes of a step have not found its state: contact and attraction take nearly all of a grid that ends. Enlarge the
    /// grid: a body that ends goes on beyond its edge with an infinite gap.
    #[error("at t = {} s no state was found: contact and attraction span {:.0} % of the grid of {} × {} m, where steps \
        end for certain up to {:.0} %: enlarge the grid (beyond a body that ends the gap is infinite), or give a \
        surface that repeats a periodic body",
        rounded(*.time, TIME), 100.0 * share, rounded(.lengths[0], 4), rounded(.lengths[1], 4), 100.0 * most)]
    FillsGrid {
        /// End of the step \[s\].
        time: f64,
        /// The part of a side that they span.
        share: f64,
        /// The part up to which steps end.
        most: f64,
        /// Lengths of the grid \[m\].
        lengths: [f64; 2],
    },

    /// The passes of a step have not found its state.
    #[error("at t = {} s {passes} passes left a change of the traction of {change:.1e} of its maximum, where \
        {tolerance:.1e} is allowed: take a shorter step", rounded(*.time, TIME))]
    NotConverged {
        /// End of the step \[s\].
        time: f64,
        /// Passes made.
        passes: usize,
        /// Change of the traction in the last pass, over the maximum traction of the law.
        change: f64,
        /// Change allowed.
        tolerance: f64,
    },
}

impl AdhesionError {
    pub(super) fn error_kind(&self) -> ErrorKind {
        match self {
            AdhesionError::NotConverged { .. } | AdhesionError::FillsGrid { .. } => ErrorKind::Convergence,
            _ => ErrorKind::Value,
        }
    }
}
