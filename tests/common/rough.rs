//! A rough surface shared by tests.

use viscocontact::prelude::*;

/// Self-affine from `longest` to `shortest` \[m\], the same in all directions, of Hurst exponent 0.8 and rms slope 0.05.
pub fn self_affine(longest: f64, shortest: f64, seed: u64) -> RoughSpec {
    RoughSpec::new(longest, shortest, Roughness::RmsSlope(0.05)).with_seed(seed)
}
