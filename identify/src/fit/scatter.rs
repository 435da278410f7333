//! Noise of a drive that the force does not follow.

use crate::forward::Sample;

/// Share of its scatter that the force of a drive with errors of measurement does not show, at least.
const UNSEEN: f64 = 0.5;
/// Standard deviations from 0 of this share that chance does not reach.
const CERTAIN: f64 = 4.0;

/// Whether the scatter of a drive is an error of its measurement: a tip that moves so has a force that does. The second differences of the contact's force
/// as the drive gives it are compared with those of the measured force, of which a model leaves `residuals`.
pub(super) fn is_error(samples: &[Sample], residuals: &[f64]) -> bool {
    let [mut square, mut product, mut variance] = [0.0; 3];
    for (samples, residuals) in samples.windows(3).zip(residuals.windows(3)) {
        if samples.iter().any(|sample| sample.contact_depth <= 0.0) {
            continue;
        }
        let expected = samples[0].force - 2.0 * samples[1].force + samples[2].force;
        let unseen = 2.0 * residuals[1] - residuals[0] - residuals[2];
        square += expected * expected;
        product += expected * unseen;
        // second differences of white noise are correlated: products of two by 35/18 as a sum
        variance += 35.0 / 18.0 * (expected * unseen).powi(2);
    }
    product > UNSEEN * square && product > CERTAIN * variance.sqrt()
}
