use crate::adhesion::{Attraction, Scales};
use crate::error::Result;

/// An attraction that decays exponentially with the gap: s = (w/ρ) e^(−h/ρ).
///
/// ```
/// use viscocontact::adhesion::{Attraction, ExponentialAttraction};
///
/// let law = ExponentialAttraction::new(0.05, 20.0e-9)?;
/// assert_eq!(law.traction(0.0), 2.5e6);
/// assert_eq!(law.work(), 0.05);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialAttraction(Scales);

impl ExponentialAttraction {
    /// A law of the `work` of separation w \[J/m²\] and the `range` ρ \[m\].
    ///
    /// # Errors
    /// If one of them is not finite and positive, or w/ρ is not.
    pub fn new(work: f64, range: f64) -> Result<ExponentialAttraction> {
        Scales::new(work, range).map(ExponentialAttraction)
    }
}

impl Attraction for ExponentialAttraction {
    fn traction(&self, gap: f64) -> f64 {
        self.0.greatest() * (-gap / self.0.range).exp()
    }

    fn energy(&self, gap: f64) -> f64 {
        self.0.work * (-gap / self.0.range).exp()
    }
}
