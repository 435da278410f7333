//! Scenes and references that tests and benches share; those under `examples/support/scenes` examples as well.

pub mod any_scene;
pub mod bodies;
pub mod chosen_scenes;
pub mod draws;
pub mod environment;
pub mod fields;
#[path = "../../examples/support/figures.rs"]
pub mod figures;
pub mod foundation;
pub mod gauss;
pub mod histories;
#[path = "../../examples/support/scenes/indenters.rs"]
pub mod indenters;
pub mod love;
#[path = "../../examples/support/scenes/march.rs"]
pub mod march;
pub mod moving_bodies;
#[path = "../../examples/support/scenes/noise.rs"]
pub mod noise;
#[path = "../../examples/support/scenes/oscillation.rs"]
pub mod oscillation;
#[path = "../../examples/support/scenes/paper_figures.rs"]
pub mod paper_figures;
pub mod protocol;
pub mod quadratic;
pub mod random_bodies;
pub mod random_histories;
pub mod random_returns;
pub mod random_taps;
pub mod ratios;
pub mod refused;
#[path = "../../examples/support/scenes/rolling.rs"]
pub mod rolling;
pub mod rough;
pub mod rows;
pub mod runs;
pub mod scene;
pub mod sealed;
pub mod spectra;
pub mod spheres;
pub mod steady_sliding;
#[path = "../../examples/support/scenes/step_loaded_sphere.rs"]
pub mod step_loaded_sphere;
pub mod sticky;
pub mod temporary;
pub mod truth;
pub mod watched_ranks;
pub mod watched_runs;

// what most tests begin with
pub use bodies::{E_STAR, G, elastic, maxwell, power_law, three_times, zener};
pub use draws::Draws;
pub use environment::from_environment;
pub use noise::{noise, uniform};
pub use ratios::Ratios;
pub use rows::{pairs, triples};
pub use scene::{Features, Scene};
pub use spheres::{RADIUS, builder_of, builder_on, contact_of, sphere, sphere_on};
pub use step_loaded_sphere::StepLoadedSphere;
pub use temporary::Temporary;
pub use truth::Truth;
