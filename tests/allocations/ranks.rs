//! Steps of a contact that ranks share out.

use std::sync::Arc;

use stats_alloc::Region;
use viscocontact::parallel::{Ranks, Threads};
use viscocontact::prelude::*;

use crate::ALLOCATOR;
use crate::common::{builder_of, zener};

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

/// Of all ranks together, counted and announced; a quarter of the cells by symmetry, or all.
pub fn ranks_announce_what_is_counted() {
    for symmetry in [true, false] {
        let grid = Grid::square(512, 4.0e-3).unwrap();
        let shape = Sphere::new(10.0e-3).unwrap();
        let found = Threads::run(SIZE, |ranks| {
            let builder = |ranks: &Arc<dyn Ranks>| {
                ViscoelasticContact::builder(grid.clone())
                    .ranks(Arc::clone(ranks))
                    .geometry(&shape)
                    .material(zener())
                    .settings(Settings::default().with_symmetry(symmetry))
            };
            // what threads keep for the next contact is taken once
            drop(builder(&ranks).build().unwrap());
            meet(&ranks);
            let region = Region::new(ALLOCATOR);
            meet(&ranks);
            let told = builder(&ranks).memory().unwrap();
            let contact = builder(&ranks).build().unwrap();
            meet(&ranks);
            let change = region.change();
            meet(&ranks);
            drop(contact);
            (told, change.bytes_allocated as f64 - change.bytes_deallocated as f64)
        });
        let found = found.unwrap();
        let told: u64 = found.iter().map(|(told, _)| told.total()).sum();
        let counted = found[0].1 / told as f64;
        assert!((0.95..1.05).contains(&counted), "{} counted, {told} told", found[0].1);
        let cells: usize = found.iter().map(|(told, _)| told.computed_cells).sum();
        assert_eq!(cells, if symmetry { 256 * 256 } else { 512 * 512 });
    }
}

fn builder(settings: Settings, shape: &dyn Geometry) -> Builder {
    builder_of(shape, Grid::square(256, 4.0e-3).unwrap(), zener()).settings(settings)
}
