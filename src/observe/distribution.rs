//! Distributions of gap and pressure over the surface.

use crate::error::{Result, count_within, finite, positive};
use crate::values::Counted;

const MAX_BINS: usize = 1_000_000;

/// The distribution of a quantity over the surface: the share of the surface where the quantity is zero, and the
/// probability density of its positive values in bins of equal width. Together they integrate to 1, as P does in
/// Persson's theory of contact.
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Distribution {
    /// Share of the surface where the quantity is zero.
    pub share_at_zero: f64,
    /// Width of a bin, in the unit of the quantity; 0 without bins.
    pub width: f64,
    /// Density in each bin, in 1 over the unit of the quantity; empty if the quantity is zero everywhere. Its sum
    /// times the width is 1 − `share_at_zero`.
    pub density: Vec<f64>,
}

debug_by!(self: Distribution => share_at_zero: self.share_at_zero, width: self.width, density: Counted(&self.density));

impl Distribution {
    /// The distribution of `all` values, of which `positive_values` are positive and the rest are zero.
    pub(crate) fn new(
        positive_values: impl Iterator<Item = f64> + Clone,
        all: usize,
        bins: usize,
    ) -> Result<Distribution> {
        count_within("bins", bins, (1..=MAX_BINS).contains(&bins), "in [1, 1000000]")?;
        let greatest = positive_values.clone().fold(0.0, f64::max);
        if greatest == 0.0 {
            return Ok(Distribution { share_at_zero: 1.0, width: 0.0, density: Vec::new() });
        }
        let width = positive("width of a bin", greatest / bins as f64)?;
        let (mut counts, mut counted) = (vec![0_usize; bins], 0);
        for value in positive_values {
            // the last bin includes its upper end
            counts[((value / width) as usize).min(bins - 1)] += 1;
            counted += 1;
        }
        let density = counts.into_iter().map(|count| count as f64 / all as f64 / width);
        let density = density.map(|value| finite("density", value)).collect::<Result<_>>()?;
        Ok(Distribution { share_at_zero: (all - counted) as f64 / all as f64, width, density })
    }

    /// Centres of the bins, in the unit of the quantity.
    pub fn centers(&self) -> impl Iterator<Item = f64> {
        (0..self.density.len()).map(|k| (k as f64 + 0.5) * self.width)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::observe::tests::{hertz, sphere};
    use crate::prelude::*;

    #[test]
    fn values_are_counted_in_their_bins() {
        let found = Distribution::new([1.0, 2.5, 4.0, 3.9, 0.5].into_iter(), 8, 4).unwrap();
        assert_eq!(found, Distribution { share_at_zero: 0.375, width: 1.0, density: vec![0.125, 0.125, 0.125, 0.25] });
        assert_eq!(found.centers().collect::<Vec<_>>(), [0.5, 1.5, 2.5, 3.5]);
        let none = Distribution::new(std::iter::empty(), 8, 4).unwrap();
        assert_eq!((none.share_at_zero, none.density.len(), none.width), (1.0, 0, 0.0));
        for bins in [0, MAX_BINS + 1] {
            assert!(matches!(Distribution::new([1.0].into_iter(), 1, bins), Err(Error::CountOutOfRange { .. })));
        }
        // a width that underflows
        assert!(matches!(Distribution::new([5e-324].into_iter(), 1, 2), Err(Error::OutOfRange { .. })));
    }

    /// Under a sphere p² falls linearly with the area: the density of the pressure is 2πa² p / p0², over the area of
    /// the grid.
    #[test]
    fn pressures_under_a_sphere() {
        let [a, peak] = hertz(0.5);
        let side = 2.6 * a;
        let found = sphere([256; 2], [side; 2], [0.0; 2], 0.5).fields().pressure_distribution(10).unwrap();
        let scale = 2.0 * std::f64::consts::PI * (a / side).powi(2) / peak.powi(2);
        for (p, density) in found.centers().zip(&found.density) {
            // each tenth of the peak holds at least 200 cells
            assert!((density - scale * p).abs() < 0.03 * scale * peak, "{p:e}: {density:e} {:e}", scale * p);
        }
        let share = std::f64::consts::PI * (a / side).powi(2);
        assert_abs_diff_eq!(1.0 - found.share_at_zero, share, epsilon = 0.01 * share);
    }

    #[test]
    fn shares_add_up_and_cells_with_infinite_gap_do_not_count() {
        let mut contact = ViscoelasticContact::builder(Grid::square(40, 4.0e-3).unwrap())
            .geometry(&FlatPunch::circular(1.0e-3).unwrap())
            .material(Material::incompressible(Elastic::new(1.0e6).unwrap()))
            .build()
            .unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        let found = contact.fields().gap_distribution(5).unwrap();
        assert_eq!((found.share_at_zero, found.density.len()), (1.0, 0));

        let contact = sphere([32; 2], [4.0e-3; 2], [0.0; 2], 0.5);
        let found = contact.fields().gap_distribution(50).unwrap();
        assert_eq!(found.share_at_zero, contact.contact_cells() as f64 / 1024.0);
        let sum = found.density.iter().sum::<f64>() * found.width;
        assert_abs_diff_eq!(sum + found.share_at_zero, 1.0, epsilon = 1e-12);
        let corner = contact.fields().profile(crate::Axis::X1, -2.0e-3).unwrap().gap[0];
        assert_abs_diff_eq!(found.width * 50.0 / corner, 1.0, epsilon = 1e-12);
    }
}
