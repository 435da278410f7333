//! The work along the surface, and where it went.

use crate::friction::contact::FrictionContact;
use crate::load::along::LateralWork;

impl FrictionContact {
    /// Where the work along the surface went. Of a jump under a constant normal load it is exact as far as each cell
    /// slips in one direction; where the normal load jumps too, the loss is that of one step. What the bodies store
    /// takes a convolution for each of their springs.
    pub fn lateral_work(&self) -> LateralWork {
        let [work, slip] = self.state.work;
        LateralWork::new(work, slip, self.stored())
    }

    /// ½ Σ E∞ U K U + ½ Σ q_i K q_i/E_i over the springs of the bodies.
    fn stored(&self) -> f64 {
        let (history, mut operator) = (&self.state.history, self.kernel.operator.clone());
        let springs = history.stresses().map(|(modulus, stress)| (modulus.recip(), stress));
        let mut displaced = vec![0.0; 2 * self.state.region.len()];
        let mut energy = |(factor, field): (f64, &[f64])| {
            operator.apply(field, &mut displaced);
            0.5 * factor * field.iter().zip(&displaced).map(|(one, two)| one * two).sum::<f64>()
        };
        let all = springs.chain([(history.rule().equilibrium(), history.displacements())]);
        self.normal.grid().cell_area()
            * all.filter(|(factor, field)| *factor > 0.0 && !field.is_empty()).map(&mut energy).sum::<f64>()
    }
}
