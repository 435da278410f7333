//! Scenes and helpers that several groups of tests share.
#![allow(dead_code, reason = "each group takes what it needs")]

pub mod bodies;
pub mod draws;
pub mod environment;
pub mod histories;
pub mod indenters;
pub mod noise;
pub mod oscillation;
pub mod paper_figures;
pub mod protocol;
pub mod random_bodies;
pub mod random_histories;
pub mod random_scenes;
#[cfg(feature = "laws")]
pub mod related;
pub mod rolling;
pub mod rough;
pub mod runs;
pub mod spectra;
pub mod spheres;
pub mod step_loaded_sphere;
pub mod truth;
pub mod watched_runs;
