//! Is what goes in checked, and what comes out whole: errors, warnings, saved states, files, pictures, documents?

mod absurd_sizes;
#[cfg(feature = "checkpoint")]
mod checkpoint;
mod diagnosis;
mod documents;
mod errors;
mod house;
mod interface;
mod invalid_loads;
#[cfg(any(feature = "csv", feature = "npy", feature = "vtk"))]
mod output;
#[cfg(all(feature = "csv", feature = "npy", feature = "vtk"))]
mod output_of_ranks;
mod paper;
#[cfg(feature = "plot")]
mod plot;
mod snapshot;
#[cfg(feature = "tracing")]
mod tracing;
