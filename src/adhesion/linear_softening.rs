use crate::adhesion::{Attraction, Scales};
use crate::error::Result;

/// An attraction that falls linearly with the gap, to zero at h = 2ρ: s = (w/ρ)(1 − h/2ρ).
///
/// ```
/// use viscocontact::adhesion::{Attraction, LinearSoftening};
///
/// let law = LinearSoftening::new(0.05, 20.0e-9)?;
/// assert_eq!([law.traction(20.0e-9), law.traction(50.0e-9)], [1.25e6, 0.0]);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearSoftening(Scales);

impl LinearSoftening {
    /// A law of the `work` of separation w \[J/m²\] and the `range` ρ \[m\], half the gap at which the attraction ends.
    ///
    /// # Errors
    /// If one of them is not finite and positive, or w/ρ is not.
    pub fn new(work: f64, range: f64) -> Result<LinearSoftening> {
        Scales::new(work, range).map(LinearSoftening)
    }

    /// 1 − h/2ρ, at least zero.
    fn share(&self, gap: f64) -> f64 {
        (1.0 - 0.5 * gap / self.0.range).max(0.0)
    }
}

impl Attraction for LinearSoftening {
    fn traction(&self, gap: f64) -> f64 {
        self.0.greatest() * self.share(gap)
    }

    fn energy(&self, gap: f64) -> f64 {
        self.0.work * self.share(gap).powi(2)
    }
}
