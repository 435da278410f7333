//! Friction on elastic states.

mod bodies;
mod dense;
mod gradients;
mod runs;
mod steps;
