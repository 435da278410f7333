//! Steps whose work threads share. A call from outside of their pool goes through its queue.

use stats_alloc::Region;
use viscocontact::prelude::*;

use crate::ALLOCATOR;
use crate::common::{sphere_on, zener};

const STEPS: usize = 100;
/// Calls of a step: its contact problem, and the estimate of its error.
const CALLS: usize = 2;
/// The queue takes a block for so many calls.
const CALLS_TO_A_BLOCK: usize = 63;

/// Allocations of warm steps on the whole grid.
fn counted() -> usize {
    let settings = Settings::default().with_symmetry(false).with_window(false);
    let mut contact = sphere_on(Grid::square(256, 4.0e-3).unwrap(), zener(), settings);
    contact.step(0.0, Load::force(1.0)).unwrap();
    let region = Region::new(ALLOCATOR);
    for _ in 0..STEPS {
        contact.step(0.02, Load::force(1.0)).unwrap();
    }
    let change = region.change();
    change.allocations + change.reallocations
}

pub fn steps_on_threads_allocate_blocks_of_a_queue() {
    // not before: what threads allocate when they start would be counted in other tests
    rayon::ThreadPoolBuilder::new().num_threads(2).build_global().unwrap();
    rayon::broadcast(|_| ());
    let (outside, inside) = (counted(), rayon::scope(|_| counted()));
    println!("{outside} allocations in {STEPS} steps outside of the pool, {inside} inside");
    // the last block may be nearly full at first
    assert!(outside <= CALLS * STEPS / CALLS_TO_A_BLOCK + 1, "{outside} outside of the pool");
    assert_eq!(inside, 0);
}
