//! Position of a contact relative to a reference point.

use crate::Grid;
use crate::sum::greatest;

/// Position of a contact relative to a point, see
/// [`Fields::asymmetry`](crate::fields::Fields::asymmetry).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Asymmetry {
    /// Centre of pressure, ∬ p x / ∬ p along x1 and x2 \[m\], from the origin of the grid.
    pub center_of_pressure: [f64; 2],
    /// Distance from the point to the ends of the contact \[m\]: for each axis towards lower and towards higher
    /// coordinates, to the outer sides of the last cells in contact; negative if the whole contact lies on the other
    /// side.
    pub reach: [[f64; 2]; 2],
}

impl Asymmetry {
    /// Difference between the reach towards higher and towards lower coordinates, relative to the length of the
    /// contact, for each axis: 0 for a contact that is symmetric about the point, ±1 for one that begins there.
    pub fn skewness(&self) -> [f64; 2] {
        self.reach.map(|[lower, higher]| (higher - lower) / (higher + lower))
    }

    /// Asymmetry of `pressure` \[Pa\] about the point `about` \[m\]; `None` without contact.
    pub(crate) fn new(grid: &Grid, pressure: &[f64], periodic: [bool; 2], about: [f64; 2]) -> Option<Asymmetry> {
        let (n2, lengths, highest) = (grid.cells()[1], grid.lengths(), greatest(pressure));
        if highest == 0.0 {
            return None;
        }
        // relative to the highest pressure, so that no sum overflows
        let (mut weight, mut moment) = (0.0, [0.0; 2]);
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (k, p) in pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let (cell, share) = ([k / n2, k % n2], p / highest);
            weight += share;
            for axis in 0..2 {
                let distance = grid.coordinate(axis, cell[axis]) - about[axis];
                let periods = if periodic[axis] { (distance / lengths[axis]).round() } else { 0.0 };
                let distance = distance - periods * lengths[axis];
                moment[axis] += share * distance;
                bounds[axis] = [bounds[axis][0].min(distance), bounds[axis][1].max(distance)];
            }
        }
        let reach = [0, 1].map(|axis| {
            let half = 0.5 * grid.spacing()[axis];
            [half - bounds[axis][0], half + bounds[axis][1]]
        });
        let center_of_pressure = [0, 1].map(|axis| about[axis] + moment[axis] / weight);
        Some(Asymmetry { center_of_pressure, reach })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use crate::observe::tests::{hertz, sphere};

    #[test]
    fn a_sphere_off_the_origin() {
        let [a, _] = hertz(0.2);
        let contact = sphere([120, 100], [2.4e-3, 2.0e-3], [0.3e-3, -0.2e-3], 0.2);
        let found = contact.fields().asymmetry([0.1e-3, -0.2e-3]).unwrap().unwrap();
        let [x1, x2] = found.center_of_pressure;
        assert!((x1 - 0.3e-3).abs() < 1e-7 && (x2 + 0.2e-3).abs() < 1e-7, "{x1:e} {x2:e}");
        assert_abs_diff_eq!(contact.fields().moment()[0] / contact.force(), x1, epsilon = 1e-15);
        // within a cell
        for (found, exact) in found.reach.as_flattened().iter().zip([a - 0.2e-3, a + 0.2e-3, a, a]) {
            assert!((found - exact).abs() < 20.0e-6, "{found:e} {exact:e}");
        }
        assert_abs_diff_eq!(found.skewness()[0], 0.2e-3 / a, epsilon = 0.05);
        assert!(found.skewness()[1].abs() < 1e-9);
        // about a point beyond its edge the whole contact lies on one side
        let beyond = contact.fields().asymmetry([1.1e-3, 0.0]).unwrap().unwrap();
        assert!(beyond.reach[0][1] < 0.0 && beyond.skewness()[0] < -1.0);
        assert_eq!(contact.fields().asymmetry([f64::NAN, 0.0]).unwrap_err().kind(), crate::ErrorKind::Value);
    }

    #[test]
    fn a_contact_across_the_periodic_boundary() {
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
        let found = contact.fields().asymmetry([at, 0.0]).unwrap().unwrap();
        assert!((found.center_of_pressure[0] - at).abs() < 1e-6, "{found:?}");
        assert!(found.reach[0].iter().all(|reach| (0.1e-3..1.0e-3).contains(reach)), "{found:?}");
    }
}
