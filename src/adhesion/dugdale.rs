use crate::adhesion::{Attraction, Scales};
use crate::error::{Result, within};

/// The constant attraction of Dugdale and Maugis, s = w/ρ up to the gap ρ, with an end of stated width: over the gaps
/// ρ (1 ± b/2) it falls linearly to zero. At a sharp end single cells would jump, each at a load of its own, and pull
/// harder than the law: the zone in which the traction falls, of the length b E* ρ²/w, must have 4 cells or more.
///
/// ```
/// use viscocontact::adhesion::{Attraction, Dugdale};
///
/// let law = Dugdale::new(0.05, 20.0e-9)?.with_width(0.1)?;
/// assert_eq!([18.0e-9, 20.0e-9, 22.0e-9].map(|gap| (law.traction(gap) * 1e-4).round()), [250.0, 125.0, 0.0]);
/// assert_eq!(law.range(), 20.0e-9);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dugdale {
    scales: Scales,
    width: f64,
}

impl Dugdale {
    /// A law of the `work` of separation w \[J/m²\] and the `range` ρ \[m\], with an end of width b = 1/2 of the range.
    ///
    /// # Errors
    /// If one of them is not finite and positive, or w/ρ is not.
    pub fn new(work: f64, range: f64) -> Result<Dugdale> {
        Ok(Dugdale { scales: Scales::new(work, range)?, width: 0.5 })
    }

    /// Another width b of its end, over the range: at b = 2 it is
    /// [`LinearSoftening`](crate::adhesion::LinearSoftening).
    ///
    /// # Errors
    /// If b is not in \[0.01, 2\].
    pub fn with_width(self, width: f64) -> Result<Dugdale> {
        within("width of the end of Dugdale's law", width, (0.01..=2.0).contains(&width), "in [0.01, 2]")?;
        Ok(Dugdale { width, ..self })
    }

    /// How far the gap is from the end of the attraction, over the range.
    fn left(&self, gap: f64) -> f64 {
        (1.0 + 0.5 * self.width - gap / self.scales.range).max(0.0)
    }
}

impl Attraction for Dugdale {
    fn traction(&self, gap: f64) -> f64 {
        self.scales.greatest() * (self.left(gap) / self.width).min(1.0)
    }

    fn energy(&self, gap: f64) -> f64 {
        let left = self.left(gap);
        // the triangle of the end, then the constant part
        let area = if left < self.width { 0.5 * left * left / self.width } else { left - 0.5 * self.width };
        self.scales.work * area
    }
}
