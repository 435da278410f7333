//! Whether a material and a layer have the same Poisson's ratio.

use crate::error::{Refusal, Result};
use crate::rheology::Material;

impl Material {
    /// Rejects a layer of the Poisson's ratio `layer` that is not that of this material.
    pub(crate) fn check_ratio_of(&self, layer: f64) -> Result<()> {
        let refused = |what: &str| {
            let what = format!("the layer was made for a Poisson's ratio of {layer} at all times, and {what}");
            let remedy = ": give both one ratio (a layer takes its thickness first, then the ratio), and no body that \
                deforms against it";
            Err(Refusal::value("kernel_layer_material", what, remedy).into())
        };
        let ratios: Vec<_> = self.poisson_ratios().collect();
        match ratios[..] {
            // but for rounding
            [Some(nu)] if (nu - layer).abs() <= 1e-9 => Ok(()),
            // to the digits that were given
            [Some(nu)] => refused(&format!(
                "the material has the constant ratio {}: give both the same, a layer after its thickness",
                (nu * 1e9).round() / 1e9
            )),
            [None] => refused("that of a material with an elastic bulk rises in time: take one of constant ratio"),
            _ => refused("a counter body deforms, too, as a half-space and in a time of its own: make it rigid"),
        }
    }
}
