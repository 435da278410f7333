//! Friction on elastic states.

mod bodies;
mod dense;
mod runs;
mod steps;
