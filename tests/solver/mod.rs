//! Is the contact problem of a step solved, whatever the scene, the load, the solver and the region?

mod adhesion;
mod adhesion_adaptive;
mod adhesion_population;
mod conditions;
mod differential;
mod extremes;
mod limits;
mod loads;
mod population;
mod ranks_together;
mod region;
mod several;
mod work;
