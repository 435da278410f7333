//! Random exponential series.

use proptest::prelude::*;
use viscocontact::rheology::CreepSpectrum;

prop_compose! {
    /// Solids and fluids, with and without elastic response, up to 12 terms over 20 decades.
    pub fn spectra()(
        glassy in prop_oneof![Just(0.0), 1e-3..1e3_f64],
        fluidity in prop_oneof![Just(0.0), 1e-9..1e9_f64],
        terms in prop::collection::vec((-4.0..4.0_f64, -10.0..10.0_f64), 1..12),
    ) -> CreepSpectrum {
        let terms: Vec<_> = terms.iter().map(|&(c, lambda)| (10f64.powf(c), 10f64.powf(lambda))).collect();
        CreepSpectrum::new(glassy, fluidity, &terms).unwrap()
    }
}
