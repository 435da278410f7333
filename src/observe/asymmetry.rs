//! Contacts that are pressed to one side.

use crate::ViscoelasticContact;
use crate::error::{Result, finite};

/// How a contact lies about a point, see [`ViscoelasticContact::asymmetry`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Asymmetry {
    /// Where the force acts: ∬ p x / ∬ p along x1 and x2 \[m\], from the origin of the grid.
    pub center_of_pressure: [f64; 2],
    /// How far the contact reaches from the point \[m\]: for each axis towards lower and towards higher coordinates, to
    /// the outer sides of the last cells in contact; negative if all of it lies on the other side.
    pub reach: [[f64; 2]; 2],
}

impl Asymmetry {
    /// How much farther the contact reaches towards higher coordinates, relative to its length, for each axis: 0 for
    /// a contact that is symmetric about the point, ±1 for one that begins there.
    pub fn skewness(&self) -> [f64; 2] {
        self.reach.map(|[lower, higher]| (higher - lower) / (higher + lower))
    }
}

impl ViscoelasticContact {
    /// How the contact lies about the point `about` \[m\], as the point of a roller that is lowest; `None` without
    /// contact. Of several patches, all together; where the bodies are periodic each cell counts where it is nearest to the
    /// point, and the centre of pressure may lie beyond the grid.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
    ///     .build()?;
    /// assert_eq!(contact.asymmetry([0.0; 2])?, None);
    /// contact.step(0.0, Load::force(0.5))?;
    /// let asymmetry = contact.asymmetry([0.0; 2])?.expect("it is pressed");
    /// assert!(asymmetry.skewness()[0].abs() < 1e-12);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If a coordinate is not finite.
    pub fn asymmetry(&self, about: [f64; 2]) -> Result<Option<Asymmetry>> {
        finite("point along x1", about[0])?;
        finite("point along x2", about[1])?;
        let (grid, n2) = (self.grid(), self.grid().cells()[1]);
        let touched = || self.pressure().iter().enumerate().filter(|(_, p)| **p > 0.0);
        let greatest = self.greatest_pressure();
        if greatest == 0.0 {
            return Ok(None);
        }
        // relative to the greatest, no sum leaves the range of f64
        let (mut weight, mut moment) = (0.0, [0.0; 2]);
        let (lengths, periodic) = (grid.lengths(), self.kernel().periodic_axes());
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (k, p) in touched() {
            let (cell, share) = ([k / n2, k % n2], p / greatest);
            weight += share;
            for axis in 0..2 {
                let distance = grid.coordinate(axis, cell[axis]) - about[axis];
                let turns = if periodic[axis] { (distance / lengths[axis]).round() } else { 0.0 };
                let distance = distance - turns * lengths[axis];
                moment[axis] += share * distance;
                bounds[axis] = [bounds[axis][0].min(distance), bounds[axis][1].max(distance)];
            }
        }
        let reach = [0, 1].map(|axis| {
            let half = 0.5 * grid.spacing()[axis];
            [half - bounds[axis][0], half + bounds[axis][1]]
        });
        let center_of_pressure = [0, 1].map(|axis| about[axis] + moment[axis] / weight);
        Ok(Some(Asymmetry { center_of_pressure, reach }))
    }
}

#[cfg(test)]
mod tests {
    use crate::analytic::Hertz;
    use crate::observe::sphere;

    #[test]
    fn a_sphere_that_is_off_the_origin() {
        let a = Hertz::new(10.0e-3, 4.0e6, 0.2).unwrap().contact_radius();
        let contact = sphere([120, 100], [2.4e-3, 2.0e-3], [0.3e-3, -0.2e-3], 0.2);
        let found = contact.asymmetry([0.1e-3, -0.2e-3]).unwrap().unwrap();
        let [x1, x2] = found.center_of_pressure;
        assert!((x1 - 0.3e-3).abs() < 1e-7 && (x2 + 0.2e-3).abs() < 1e-7, "{x1:e} {x2:e}");
        assert!((contact.moment()[0] / contact.force() - x1).abs() < 1e-15);
        // to a cell
        for (found, exact) in found.reach.as_flattened().iter().zip([a - 0.2e-3, a + 0.2e-3, a, a]) {
            assert!((found - exact).abs() < 20.0e-6, "{found:e} {exact:e}");
        }
        assert!((found.skewness()[0] - 0.2e-3 / a).abs() < 0.05);
        assert!(found.skewness()[1].abs() < 1e-9);
        // seen from beyond its edge it lies on one side
        let beyond = contact.asymmetry([1.1e-3, 0.0]).unwrap().unwrap();
        assert!(beyond.reach[0][1] < 0.0 && beyond.skewness()[0] < -1.0);
        assert!(contact.asymmetry([f64::NAN, 0.0]).is_err());
    }

    #[test]
    fn a_contact_across_the_seam_of_a_period() {
        use crate::prelude::*;

        let grid = Grid::new([64, 1], [4.0e-3, 1.0]).unwrap();
        let cylinder = Repeated::new(Cylinder::new(5.0e-3).unwrap(), [4.0e-3, f64::INFINITY]).unwrap();
        let at = 1.9e-3;
        let mut contact = ViscoelasticContact::builder(grid.clone())
            .geometry(&Shifted::new(cylinder, [at, 0.0]).unwrap())
            .material(Material::incompressible(Elastic::new(1.0e6).unwrap()))
            .kernel(std::sync::Arc::new(InfluenceKernel::periodic(&grid).unwrap()))
            .build()
            .unwrap();
        contact.step(0.0, Load::force(50.0)).unwrap();
        let found = contact.asymmetry([at, 0.0]).unwrap().unwrap();
        assert!((found.center_of_pressure[0] - at).abs() < 1e-6, "{found:?}");
        assert!(found.reach[0].iter().all(|reach| (0.1e-3..1.0e-3).contains(reach)), "{found:?}");
    }
}
