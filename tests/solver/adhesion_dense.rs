//! Elastic rough adhesion against an independent dense solution: the energy of the gap with the inverse of a matrix of Love's coefficients,
//! minimised by a projected Newton method. `ADHESION_DENSE` (4) chooses the number of random surfaces.

use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::fields::traction;
use crate::common::love::love;
use crate::common::quadratic::solve_definite;
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction, LinearSoftening, VanDerWaals};
use viscocontact::prelude::*;

const CELLS: usize = 10;
const SIDE: f64 = 3.3;
const ALL: usize = CELLS * CELLS;

/// The bodies as an energy of their gaps: ½ (h − d)ᵀ K⁻¹ (h − d) − Σ ∫ₕ^∞ s, with d the gap of rigid bodies.
struct Dense<'a> {
    inverse: Vec<Vec<f64>>,
    law: &'a dyn Attraction,
}

impl Dense<'_> {
    fn new(law: &dyn Attraction) -> Dense<'_> {
        let side = SIDE / CELLS as f64;
        let at = |k: usize| [k / CELLS, k % CELLS].map(|index| index as f64 * side);
        let between = |k: usize| [0, 1].map(|axis| at(k / ALL)[axis] - at(k % ALL)[axis]);
        let matrix: Vec<f64> = (0..ALL * ALL).map(|k| love(between(k), [side; 2])).collect();
        let unit = |k: usize| -> Vec<f64> { (0..ALL).map(|i| f64::from(u8::from(i == k))).collect() };
        Dense { inverse: (0..ALL).map(|k| solve_definite(&matrix, &unit(k)).unwrap()).collect(), law }
    }

    /// Net traction of the body: K⁻¹ (h − d).
    fn traction(&self, gap: &[f64], rigid: &[f64]) -> Vec<f64> {
        let lifted: Vec<f64> = gap.iter().zip(rigid).map(|(h, d)| h - d).collect();
        self.inverse.iter().map(|row| row.iter().zip(&lifted).map(|(a, x)| a * x).sum()).collect()
    }

    fn energy(&self, gap: &[f64], rigid: &[f64]) -> f64 {
        let lifted = gap.iter().zip(rigid).map(|(h, d)| h - d);
        let stored: f64 = self.traction(gap, rigid).into_iter().zip(lifted).map(|(q, u)| 0.5 * q * u).sum();
        stored - gap.iter().map(|&h| self.law.energy(h)).sum::<f64>()
    }

    /// Descends from `gap` to a minimum.
    fn minimise(&self, gap: &mut Vec<f64>, rigid: &[f64]) {
        let greatest = self.law.traction(0.0);
        for _ in 0..1000 {
            let slope: Vec<f64> =
                self.traction(gap, rigid).iter().zip(&*gap).map(|(q, &h)| q + self.law.traction(h)).collect();
            let free: Vec<usize> = (0..ALL).filter(|&k| gap[k] > 0.0 || slope[k] < 0.0).collect();
            if free.iter().all(|&k| slope[k].abs() < 1e-9 * greatest) {
                return;
            }
            let softens = |h: f64| {
                let by = 1e-6 * self.law.range();
                (self.law.traction((h - by).max(0.0)) - self.law.traction(h + by)) / (h + by - (h - by).max(0.0))
            };
            let mut shift = 0.0;
            let direction = loop {
                let own = |i: usize, j: usize| self.inverse[i][j] + if i == j { shift - softens(gap[i]) } else { 0.0 };
                let matrix: Vec<f64> = free.iter().flat_map(|&i| free.iter().map(move |&j| own(i, j))).collect();
                let down: Vec<f64> = free.iter().map(|&k| -slope[k]).collect();
                match solve_definite(&matrix, &down) {
                    Some(direction) => break direction,
                    None => shift = 2.0 * shift + 0.1 * greatest / self.law.range(),
                }
            };
            let (before, mut length) = (self.energy(gap, rigid), 1.0);
            loop {
                let mut next = gap.clone();
                free.iter().zip(&direction).for_each(|(&k, step)| next[k] = (gap[k] + length * step).max(0.0));
                let gained: f64 = free.iter().map(|&k| slope[k] * (next[k] - gap[k])).sum();
                if self.energy(&next, rigid) <= before + 1e-4 * gained.min(0.0) + 1e-15 * before.abs() || length < 1e-10
                {
                    *gap = next;
                    break;
                }
                length *= 0.5;
            }
        }
        panic!("the dense solution does not converge");
    }
}

#[test]
fn elastic_rough_adhesion_is_the_least_energy_of_a_dense_matrix() {
    let (mut worst, mut jumps, mut states) = (0.0_f64, 0, 0);
    for scene in 0..from_environment("ADHESION_DENSE", 4) {
        let mut draws = Draws::new(700 + scene);
        let range = draws.between(0.9, 1.6);
        let law: Box<dyn Attraction> = match scene % 4 {
            0 => Box::new(ExponentialAttraction::new(1.0, range).unwrap()),
            1 => Box::new(VanDerWaals::new(1.0, 1.2 * range).unwrap()),
            2 => Box::new(LinearSoftening::new(1.0, range).unwrap()),
            _ => Box::new(Dugdale::new(1.0, range).unwrap().with_width(1.0).unwrap()),
        };
        let heights: Vec<f64> = (0..ALL).map(|_| draws.between(0.0, 1.2)).collect();
        let grid = Grid::square(CELLS, SIDE).unwrap();
        let side = SIDE / CELLS as f64;
        let of = heights.clone();
        let rough = move |x: f64, y: f64| {
            let [i, j] = [x, y].map(|x| ((x / side + 0.5 * CELLS as f64).floor() as usize).min(CELLS - 1));
            of[i * CELLS + j]
        };
        let law: std::sync::Arc<dyn Attraction> = law.into();
        let mut contact = ViscoelasticContact::builder(grid)
            .geometry(&FnGeometry::new(rough))
            .material(Material::incompressible(Elastic::new(0.25).unwrap()))
            .attraction(std::sync::Arc::clone(&law))
            .settings(Settings::default().with_edge(Edge::Allow).with_tolerance(1e-7))
            .build()
            .unwrap();
        let dense = Dense::new(&*law);
        let (mut gap, mut before) = (vec![0.0; ALL], 0.0);
        let mut apart = [false; 2];
        for k in 0..=32 {
            let approach = 1.5 - 0.09 * (f64::from(k) - 16.0).abs();
            states += 1;
            let rigid: Vec<f64> = heights.iter().map(|h| h - approach).collect();
            if k == 0 {
                gap.clone_from(&rigid);
            } else {
                gap.iter_mut().for_each(|h| *h = (*h - (approach - before)).max(0.0));
            }
            before = approach;
            dense.minimise(&mut gap, &rigid);
            let expected = dense.traction(&gap, &rigid);
            contact.step(1.0, Load::approach(approach)).unwrap();
            let found = traction(contact.fields());
            let greatest = law.traction(0.0);
            let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / greatest;
            // the two may jump in neighbouring steps
            apart = [error > 1e-3, apart[0]];
            assert!(apart != [true; 2], "scene {scene}, {law:?}, step {k}: {error}");
            if apart[0] {
                jumps += 1;
            } else {
                worst = worst.max(error);
            }
        }
    }
    println!(
        "{states} states: greatest difference of a traction {worst:.1e} of the greatest, {jumps} between the jumps of the two"
    );
    assert!(worst < 1e-4 && 20 * jumps <= states, "{worst} {jumps} {states}");
}
