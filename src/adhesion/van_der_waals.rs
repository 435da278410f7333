use crate::adhesion::{Attraction, Scales};
use crate::error::Result;

/// The attraction of half-spaces whose molecules attract each other with the sixth power of their distance:
/// s = (2w/h₀)(1 + h/h₀)^(−3), with h₀ = 2ρ the distance of the surfaces in contact.
///
/// ```
/// use viscocontact::adhesion::{Attraction, VanDerWaals};
///
/// let law = VanDerWaals::new(0.05, 0.2e-9)?;
/// assert!((law.traction(0.4e-9) / law.traction(0.0) - 0.125).abs() < 1e-15);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VanDerWaals(Scales);

impl VanDerWaals {
    /// A law of the `work` of separation w \[J/m²\] and the `range` ρ = h₀/2 \[m\].
    ///
    /// # Errors
    /// If one of them is not finite and positive, or w/ρ is not.
    pub fn new(work: f64, range: f64) -> Result<VanDerWaals> {
        Scales::new(work, range).map(VanDerWaals)
    }

    /// h₀/(h₀ + h).
    fn nearness(&self, gap: f64) -> f64 {
        1.0 / (1.0 + 0.5 * gap / self.0.range)
    }
}

impl Attraction for VanDerWaals {
    fn traction(&self, gap: f64) -> f64 {
        self.0.greatest() * self.nearness(gap).powi(3)
    }

    fn energy(&self, gap: f64) -> f64 {
        self.0.work * self.nearness(gap).powi(2)
    }
}
