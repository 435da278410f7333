//! A past that waits for its exponential series.

use crate::error::Result;
use crate::hereditary::Exponential;
use crate::rheology::Material;

/// Unless the scene says over which times its material is wanted, the first step that takes time does: from a
/// hundredth of its length, so that what happens within a step is resolved, ...
const WITHIN_STEP: f64 = 1e-2;
/// ... to a million times its length, or to the end of the run where that is known and later.
const STEPS_AHEAD: f64 = 1e6;

/// No scene lasts longer \[s\].
const LATEST: f64 = 1e80;

/// The history of a body whose rheology has no exact series, before the first step that takes time: there
/// may have been jumps, which it answered elastically. The first such step fits the series.
#[derive(Debug, Clone)]
pub(crate) struct Unfitted {
    material: Material,
    tolerance: f64,
    cells: usize,
    /// How long the run is known to last after its start \[s\].
    pub(crate) expected: f64,
    /// What the step predicted last will leave, unless it was a jump.
    fitted: Option<Fitted>,
}

#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) material: Material,
    pub(crate) history: Exponential,
    /// The times it was fitted over.
    pub(crate) times: [f64; 2],
}

impl Unfitted {
    pub(crate) fn new(material: Material, tolerance: f64) -> Unfitted {
        Unfitted { material, tolerance, cells: 0, expected: 0.0, fitted: None }
    }

    pub(crate) fn predict(&mut self, dt: f64, displacement: &[f64], u_old: &mut [f64]) -> Result<f64> {
        if dt == 0.0 {
            self.fitted = None;
            u_old.fill(0.0);
            return self.material.checked_compliance(0.0, (0.0, 0.0));
        }
        let last = (STEPS_AHEAD * dt).max(self.expected).min(self.material.known_until());
        let times = [WITHIN_STEP * dt, last.clamp(dt, LATEST.max(dt))];
        // a step tried again need not fit again
        if self.fitted.as_ref().is_none_or(|fitted| fitted.times != times) {
            let material = self.material.fitted(times[0]..=times[1], self.tolerance)?;
            let creep = material.contact_spectrum()?.ok_or_else(|| material.no_series("a step"))?;
            let mut history = Exponential::new(&creep, self.cells);
            history.jump_from_rest(displacement);
            self.fitted = Some(Fitted { material, history, times });
        }
        match &mut self.fitted {
            Some(fitted) => Ok(fitted.history.predict(dt, displacement, u_old)),
            None => Err(self.material.no_series("a step")),
        }
    }

    /// The same past, which was jumps alone, on so many other cells.
    pub(crate) fn carry(&mut self, cells: usize) {
        (self.cells, self.fitted) = (cells, None);
    }

    /// Takes the step that was predicted last into the past, and hands over what was fitted for it; nothing for a step
    /// that left the bodies undisturbed, so that waiting decides nothing.
    pub(crate) fn commit(&mut self, touched: bool) -> Option<Fitted> {
        if !touched {
            return None;
        }
        let mut fitted = self.fitted.take()?;
        fitted.history.commit();
        Some(fitted)
    }
}
