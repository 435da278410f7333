//! Attraction between surfaces that are near each other.
//!
//! An [`Attraction`] pulls cells of gap h together with the traction s(h) ≥ 0, beside the hard wall at h = 0. It
//! never grows with the gap, and the work of separation of a unit of area is w = ∫₀^∞ s dh.
//!
//! | law | s(h), with ρ = w/s(0) |
//! |---|---|
//! | [`ExponentialAttraction`] | (w/ρ) e^(−h/ρ) |
//! | [`VanDerWaals`] | (w/ρ) (1 + h/2ρ)^(−3) |
//! | [`LinearSoftening`] | (w/ρ) (1 − h/2ρ) up to h = 2ρ |
//! | [`Dugdale`] | w/ρ up to h = ρ, with a linear end of stated width |
//!
//! Every law is given by w and ρ ([`Attraction::range`]), which is w over the maximum traction s(0). Laws of the same w
//! and ρ differ little in the pull-off force. A Lennard-Jones law with its repulsive branch is not offered: in place of
//! the wall it would put a stiff spring.

// How a step with a law is solved: `contact/step/attraction`. The trait: `crate::attraction`, which is always compiled.

mod dugdale;
mod exponential;
pub mod laws;
mod linear_softening;
mod van_der_waals;

pub use crate::attraction::Attraction;
pub use dugdale::Dugdale;
pub use exponential::ExponentialAttraction;
pub use linear_softening::LinearSoftening;
pub use van_der_waals::VanDerWaals;

use crate::error::{Result, finite, length, positive};

/// The slope at which an attraction softens \[Pa/m\]: the greater of w/ρ², its slope on average, and of the steepest
/// slope −s′ up to the gap 4ρ. On a body of contact modulus E* the attraction acts over a zone of the length E* over
/// this slope.
pub(crate) fn softening(law: &dyn Attraction) -> f64 {
    let (work, range) = (law.work(), law.range());
    // 5 differences over the narrowest end of Dugdale's law
    let step = range / 500.0;
    let (mut before, mut steepest) = (law.traction(0.0), 0.0_f64);
    for k in 1..=2000 {
        let traction = law.traction(f64::from(k) * step);
        steepest = steepest.max((before - traction) / step);
        before = traction;
    }
    steepest.max(work / range / range)
}

/// Work of separation and range of a law.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scales {
    work: f64,
    range: f64,
}

impl Scales {
    fn new(work: f64, range: f64) -> Result<Scales> {
        positive("work of separation", work)?;
        length("range of the attraction", range)?;
        positive("maximum traction of the attraction", work / range)?;
        Ok(Scales { work, range })
    }

    /// s(0).
    fn greatest(self) -> f64 {
        self.work / self.range
    }
}

/// Tabor's number μ = (R w²/(E*² ρ³))^⅓ of a sphere of `radius` R \[m\] on a body of contact `modulus` E* \[Pa\]:
/// where it is great, the contact separates as [`Jkr`](crate::analytic::Jkr) has it, where it is small, as
/// [`Dmt`](crate::analytic::Dmt).
///
/// ```
/// use viscocontact::adhesion::{ExponentialAttraction, tabor_number};
///
/// let gel = ExponentialAttraction::new(0.05, 100.0e-9)?;
/// assert!((tabor_number(&gel, 1.0e-3, 1.0e5)? - 63.0).abs() < 0.1);
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// # Errors
/// If radius or modulus is not finite and positive.
pub fn tabor_number(attraction: &dyn Attraction, radius: f64, modulus: f64) -> Result<f64> {
    positive("radius", radius)?;
    positive("contact modulus", modulus)?;
    let (strain, range) = (attraction.work() / modulus, attraction.range());
    finite("Tabor's number", (radius / range * (strain / range).powi(2)).cbrt())
}
