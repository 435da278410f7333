//! Fields that were found without a contact of their own.

use std::sync::Arc;

use crate::equilibrium::{Ground, Held, Region};
use crate::fields::{Fields, KeptFields, View};
use crate::solver::RigidMotion;

impl KeptFields {
    /// The same with a pressure on the whole grid in the place of its own; `None` where not all of these cells are
    /// computed.
    pub(crate) fn with_pressure(mut self, pressure: &[f64]) -> Option<KeptFields> {
        let Held { region, current, .. } = &mut self.held;
        let n2 = region.whole.cells()[1];
        let pressed = |k: usize| pressure[k] > 0.0;
        if (0..pressure.len()).any(|k| pressed(k) && region.find([k / n2, k % n2]).is_none()) {
            return None;
        }
        current.contact_cells = (0..pressure.len()).filter(|k| pressed(*k)).count();
        for (k, own) in current.solution.pressure.iter_mut().enumerate() {
            let [i, j] = region.cell(k);
            *own = pressure[i * n2 + j];
        }
        self.held.sum_up();
        self.view.refresh(&self.held);
        Some(self)
    }
}

impl Fields<'_> {
    /// The fields of the same rigid body in a `motion`, under a pressure and over a displacement on the whole grid.
    pub(crate) fn keep_with(
        &self,
        pressure: Vec<f64>,
        displacement: Vec<f64>,
        motion: RigidMotion,
        time: f64,
    ) -> KeptFields {
        let Fields { ground, held: Held { indenter, .. }, .. } = self;
        let mut held = Held::layout(Arc::clone(indenter), Region::whole(&ground.grid, [false; 2]));
        held.current.contact_cells = pressure.iter().filter(|p| **p > 0.0).count();
        (held.current.solution.pressure, held.current.motions[0]) = (pressure, motion);
        held.sum_up();
        let (ground, far, view) = (Ground::clone(ground), None, View::default());
        let (material, temperature) = (None, None);
        KeptFields { ground, held, displacement, far, view, time: Some(time), material, temperature }
    }
}
