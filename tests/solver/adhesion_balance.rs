//! Is the work of the load what elastic bodies store, and lose in jumps? `ADHESION_LOOPS` (3) chooses the number of random surfaces, and
//! `ADHESION_SEED` (1) others.

use std::sync::Arc;

use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction};
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// What the bodies store: ½ Σ q u, less the energy of the attraction.
fn stored(contact: &ViscoelasticContact) -> f64 {
    let cells = contact.grid().len();
    let (mut traction, mut gap) = (vec![0.0; cells], vec![0.0; cells]);
    contact.traction_into(&mut traction).unwrap();
    contact.gap_into(&mut gap).unwrap();
    let displaced = traction.iter().zip(contact.displacement()).map(|(q, u)| 0.5 * q * u);
    let attracted = gap.iter().map(|h| contact.attraction().unwrap().energy(h.max(0.0)));
    (displaced.sum::<f64>() - attracted.sum::<f64>()) * contact.grid().cell_area()
}

/// A run under given approaches that halves a step until its work is stored, or it is a jump.
struct Walk {
    contact: ViscoelasticContact,
    /// Work of the load, and energy lost in jumps.
    work: f64,
    lost: f64,
    jumps: usize,
    /// Least loss of a step that is short.
    least: f64,
}

/// Steps as short are jumps.
const SHORTEST: f64 = 1e-2;
/// Error of the work of a step, for each length, and by the tolerance of the solver.
const BY_LENGTH: f64 = 3e-4;
const BY_TOLERANCE: f64 = 1e-5;
/// Loss of a jump.
const LEAST_JUMP: f64 = 1e-3;

impl Walk {
    fn to(&mut self, approach: f64) {
        let (from, force, energy) = (self.contact.approach(), self.contact.force(), stored(&self.contact));
        let before = self.contact.clone();
        let length = approach - from;
        self.contact.step(1.0, Load::approach(approach)).unwrap();
        let work = 0.5 * (force + self.contact.force()) * length;
        let lost = work - (stored(&self.contact) - energy);
        let is_smooth = lost.abs() <= BY_LENGTH * length.abs() + BY_TOLERANCE;
        if is_smooth || length.abs() < SHORTEST {
            self.work += work;
            if lost.abs() > LEAST_JUMP {
                (self.lost, self.jumps) = (self.lost + lost, self.jumps + 1);
            }
            self.least = self.least.min(lost);
            return;
        }
        self.contact = before;
        self.to(from + 0.5 * length);
        self.to(approach);
    }
}

#[test]
fn work_is_stored_or_lost_in_jumps() {
    let mut seen = 0;
    for scene in 0..from_environment("ADHESION_LOOPS", 3) {
        let mut draws = Draws::new(10 * from_environment("ADHESION_SEED", 1) + scene);
        let (cells, side) = (64, 4.0);
        let law: Arc<dyn Attraction> = match scene % 3 {
            2 => Arc::new(Dugdale::new(1.0, 0.55).unwrap().with_width(1.0).unwrap()),
            _ => Arc::new(ExponentialAttraction::new(1.0, 0.5).unwrap()),
        };
        let wave = Wavy::new(draws.between(0.3, 0.6), side / draws.between(2.5, 3.5)).unwrap();
        let shape = Sum::new(Sphere::new(draws.between(1.0, 1.5)).unwrap(), wave);
        let mut contact = ViscoelasticContact::builder(Grid::square(cells, side).unwrap())
            .geometry(&shape)
            .material(Material::incompressible(Elastic::new(0.25).unwrap()))
            .attraction(law)
            .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(true))
            .build()
            .unwrap();
        let touch = contact.approach();
        contact.step(1.0, Load::approach(touch - 2.5)).unwrap();
        let start = stored(&contact);
        let mut walk = Walk { contact, work: 0.0, lost: 0.0, jumps: 0, least: 0.0 };
        for k in 1..=20 {
            walk.to(touch - 2.5 + 0.15 * f64::from(k));
        }
        for k in 1..=20 {
            walk.to(touch + 0.5 - 0.15 * f64::from(k));
        }
        let Walk { contact, work, lost, jumps, least } = walk;
        let gained = stored(&contact) - start;
        println!(
            "scene {scene}: work {work:.5}, stored {gained:.5}, lost {lost:.5} in {jumps} jumps, of at least {least:.1e}"
        );
        assert!((work - gained - lost).abs() < 1e-3 * work.abs().max(1.0), "scene {scene}: {work} {gained} {lost}");
        // the bodies are as they were
        assert!(gained.abs() < 1e-3, "scene {scene}: {gained}");
        assert!(least > -1e-3 && jumps <= 12, "scene {scene}: {jumps} jumps, one gains {least}");
        seen += jumps;
    }
    assert!(seen >= 2, "{seen} jumps");
}
