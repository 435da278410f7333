//! Weights of blocks of which a share is known.

/// κ: trust in the mean of a block of which only the share s is known, w = κ s/(1 + (κ − 1) s).
pub(super) const TRUST: f64 = 1.5;

/// φ of blocks of which nothing is known: w is 0, and the whole value counts.
pub(super) const NOTHING_KNOWN: f64 = 0.25 * TRUST;

/// w of a block with this φ.
#[inline(always)]
pub(super) fn weight(factor: f64) -> f64 {
    (TRUST - 4.0 * factor) / (TRUST - 1.0)
}
