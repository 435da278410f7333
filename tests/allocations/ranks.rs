//! Steps of a contact that ranks share out.

use std::sync::Arc;

use stats_alloc::Region;
use viscocontact::prelude::*;
use viscocontact::ranks::{Ranks, Threads};

use crate::ALLOCATOR;

const SIZE: usize = 3;

/// A scene, and the load of each step.
type Scene = (fn() -> Builder, fn(usize) -> Load);

/// Waits for all ranks: the allocator counts the whole process.
fn meet(ranks: &Arc<dyn Ranks>) {
    ranks.gather(&[0.0], &[1; SIZE], &mut [0.0; SIZE]).unwrap();
}

pub fn warm_steps_of_ranks_allocate_nothing() {
    let scenes: [Scene; 2] = [
        (|| builder(Settings::default(), &Sphere::new(10.0e-3).unwrap()), |step| Load::force(1.0 + 0.02 * step as f64)),
        (
            || builder(Settings::default().with_symmetry(false), &FlatPunch::circular(1.4e-3).unwrap()),
            |step| Load::eccentric_force(1.0, [0.1e-3 + 5.0e-6 * step as f64, 0.05e-3]),
        ),
    ];
    for (builder, load) in scenes {
        let changes = Threads::run(SIZE, |ranks| {
            let mut contact = builder().ranks(Arc::clone(&ranks)).build().unwrap();
            for step in 0..4 {
                contact.step(if step == 0 { 0.0 } else { 0.1 }, load(step)).unwrap();
            }
            meet(&ranks);
            let region = Region::new(ALLOCATOR);
            meet(&ranks);
            for step in 4..20 {
                contact.step(0.1, load(step)).unwrap();
            }
            meet(&ranks);
            let change = region.change();
            meet(&ranks);
            change
        });
        for change in changes.unwrap() {
            assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
        }
    }
}

fn builder(settings: Settings, shape: &dyn Geometry) -> Builder {
    ViscoelasticContact::builder(Grid::square(256, 4.0e-3).unwrap())
        .geometry(shape)
        .material(Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6).unwrap()))
        .settings(settings)
}
