//! Does it agree with closed forms, with other formulations, and with what it promises itself?

mod adhesion_theories;
mod analytic;
mod elastic;
mod energies;
mod equations;
mod few_cells;
mod layers;
mod literal;
mod mesh_error;
mod oscillation;
mod paper_figures;
mod plane;
mod rolling;
mod several_indenters;
mod stiffness;
mod stress;
mod study;
mod study_fields;
mod study_kernels;
mod study_random;
