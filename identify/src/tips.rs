//! Tips under their names.

use std::f64::consts::PI;
use std::sync::Arc;

use viscocontact::states::ElasticStates;

use crate::error::{Result, within};

/// Contact radii over the radius of a sphere: the first, below which all are powers of the radius to 1e-6, and the ratio of neighbours.
const RADII: [f64; 2] = [1e-3, 1.05];
/// Maximum contact radius over the radius of a sphere.
const GREATEST: f64 = 0.97;

/// A true sphere of `radius` R \[m\], up to a contact radius a of 0.97 R (I. N. Sneddon, Int. J. Eng. Sci. 3, 1965):
/// δ = (a/2) ln((R + a)/(R − a)), F/E* = ((a² + R²)/2) ln((R + a)/(R − a)) − aR. The paraboloid of Hertz,
/// [`ElasticStates::sphere`], is softer by about δ/10R at the depth δ.
///
/// ```
/// use viscocontact::states::ElasticStates;
/// use viscocontact_identify::tips;
///
/// let [ball, hertz] = [tips::sphere(5.0e-6)?, ElasticStates::sphere(5.0e-6)?].map(|tip| tip.level_at(1.0e-6));
/// assert!((ball / hertz - 0.98).abs() < 2e-3);
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
///
/// # Errors
/// As [`ElasticStates::sphere`].
pub fn sphere(radius: f64) -> Result<Arc<ElasticStates>> {
    within("sphere radius", radius, (1e-100..=1e100).contains(&radius), "in [1e-100, 1e100] m")?;
    let count = ((GREATEST / RADII[0]).ln() / RADII[1].ln()).ceil() as i32;
    let row = |k: i32| {
        let x = (RADII[0] * RADII[1].powi(k)).min(GREATEST);
        let half = x.atanh();
        let level = (1.0 + x * x) * half - x;
        (radius * radius * level, radius * x * half, 2.0 * radius * x, PI * (radius * x).powi(2))
    };
    let table: Vec<_> = (0..=count).map(row).collect();
    Ok(ElasticStates::from_table(&table)?)
}
