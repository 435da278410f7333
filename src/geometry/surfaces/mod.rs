//! Measured and random rough surfaces, and their statistics. Feature `surfaces`.

mod height_map;
mod height_spectrum;
mod rough;
mod statistics;

pub use height_map::{Form, HeightMap, LengthUnit};
pub use rough::{Anisotropy, Rough, RoughSpec, Roughness};
pub use statistics::SurfaceStatistics;
