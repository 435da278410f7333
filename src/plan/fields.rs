//! What a mesh leaves of the error of the pressure field.
//!
//! p = Σ w Δp_e over the levels l that are held. Nearly all of the error of p_e(l) is in its outermost cells, whose levels joined last: it
//! counts as many times more as w exceeds its mean there.

use crate::error::Result;
use crate::plan::levels::Curve;
use crate::plan::scene::{Run, TrialScene};
use crate::states::{Profile, Repeated};

/// Accuracy of the levels.
const LEVELS: f64 = 1e-2;

/// A pressure field of the run.
pub(super) struct PlannedField {
    /// The state of a mesh that it is like.
    pub(super) state: usize,
    levels: Option<FieldOnLevels>,
}

/// A contact on levels at a time.
pub(super) struct FieldOnLevels {
    pub(super) level: f64,
    profile: Profile,
    /// Its radius over the greatest of the run.
    width: f64,
    line: bool,
}

impl FieldOnLevels {
    /// The contact at these times, where the bodies touch.
    pub(super) fn at(
        scene: &TrialScene<'_>,
        curve: &Curve,
        greatest: f64,
        times: &[f64],
    ) -> Result<Vec<FieldOnLevels>> {
        let run = Repeated::new(curve.contact(scene)?, scene.asked.history, scene.asked.until, LEVELS)?.0;
        let field = |&time: &f64| {
            let contact = run.at(scene.asked.history, time, true)?.contact;
            let (level, profile) = (contact.level(), Profile::new(contact.tractions()));
            let width = curve.radius(level) / curve.radius(greatest);
            Ok(FieldOnLevels { level, profile, width, line: curve.line })
        };
        let found: Result<Vec<_>> = times.iter().map(field).collect();
        Ok(found?.into_iter().filter(|field| field.level > 0.0).collect())
    }

    /// How many times more the error of the elastic pressure counts, with so many cells across the widest contact: l ∝ a³ at the rim, a² on
    /// a line.
    fn amplification(&self, across: f64) -> f64 {
        let inner = (1.0 - 2.0 / (across * self.width)).max(0.0);
        self.profile.amplification(self.level * inner.powi(if self.line { 2 } else { 3 })).max(1.0)
    }
}

impl PlannedField {
    /// On a mesh where the levels are its own states, alike on a punch, whose errors are in proportion to the pressure.
    pub(super) fn on_levels(state: usize, levels: FieldOnLevels, punch: bool) -> PlannedField {
        PlannedField { state, levels: Some(levels).filter(|_| !punch) }
    }

    /// On a mesh whose states the run has.
    pub(super) fn of_run(run: &Run, time: f64) -> PlannedField {
        let state = run.states.partition_point(|state| state.time < time);
        PlannedField { state: state.min(run.states.len().saturating_sub(1)), levels: None }
    }

    /// The errors of the field, and of its pressure at the rim, on a mesh with so many cells across the widest contact.
    pub(super) fn errors(&self, run: &Run, across: f64) -> [f64; 2] {
        let amplification = self.levels.as_ref().map_or(1.0, |levels| levels.amplification(across));
        let of_state = run.states.get(self.state).and_then(|state| state.field);
        of_state.map_or([1.0; 2], |errors| errors.map(|error| (amplification * error).min(1.0)))
    }
}
