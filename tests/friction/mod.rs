//! Friction on elastic states.

mod bodies;
mod dense;
mod gradients;
pub(crate) mod kept;
mod runs;
mod space;
mod space_energies;
mod space_known;
mod space_runs;
mod space_saved;
mod steps;
mod sticks_again;
