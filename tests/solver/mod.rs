//! Is the contact problem of a step solved, whatever the scene, the load, the solver and the region?

mod adhesion;
mod adhesion_adaptive;
mod adhesion_balance;
mod adhesion_bodies;
mod adhesion_dense;
mod adhesion_edge;
mod adhesion_folds;
mod adhesion_front;
mod adhesion_jkr;
mod adhesion_jumps;
mod adhesion_population;
mod adhesion_separation;
mod adhesion_steps;
mod adhesion_work;
mod adhesion_zone;
mod conditions;
mod differential;
mod extremes;
mod limits;
mod loads;
mod population;
mod ranks_together;
mod region;
mod work;
